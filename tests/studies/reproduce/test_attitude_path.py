"""How directly a base turned and where its tool was: from known motions."""

from __future__ import annotations

import numpy as np
import pytest

from space_robot_description.load import load_robot
from space_robot_description.rotations import conjugate, exp, product
from space_robot_msgs_py.errors import NonFiniteError
from space_robot_msgs_py.interfaces import Vector
from space_robot_studies.reproduce.attitude_path import axis_distances, path_ratios
from space_robot_studies.reproduce.signals import tool_errors

GOAL = np.array(exp((0.3, -0.2, 0.1)))
IDENTITY = np.array([0.0, 0.0, 0.0, 1.0])


def turning(angle: float, about: Vector, ticks: int = 200) -> tuple[Vector, Vector]:
    """Attitudes and body rates of a body that turns into the goal about an axis fixed in the inertial frame."""
    left = np.linspace(angle, 0.0, ticks)
    attitude = np.array([product(exp(-x * about), GOAL) for x in left])
    rate = np.array([product(product(conjugate(q), (*about, 0.0)), q)[:3] for q in attitude])
    return attitude, rate * np.sin(np.linspace(0.0, np.pi, ticks))[:, None]


def test_the_geodesic_has_distance_zero_and_ratio_one() -> None:
    """A body that turns about one inertial axis the short way is on the geodesic all the time."""
    attitude, omega = turning(2.0, np.array([0.6, 0.0, 0.8]))
    distances, moving = axis_distances(attitude, omega, GOAL)
    np.testing.assert_allclose(distances, 0.0, atol=1e-9)
    assert moving.sum() == 198
    assert path_ratios(attitude, GOAL)[-1] == pytest.approx(1.0)


def test_the_long_way_round_is_seen() -> None:
    """Turning 300 degrees for a 60 degree rotation has the opposite axis, distance 2, and five times the path."""
    attitude, omega = turning(np.radians(300.0), np.array([0.0, 1.0, 0.0]), 400)
    distances, moving = axis_distances(attitude, omega, GOAL)
    np.testing.assert_allclose(distances[moving], 2.0, atol=1e-9)
    assert path_ratios(attitude, GOAL)[-1] == pytest.approx(5.0)


def test_a_rotation_about_another_axis_has_the_chord_between_the_axes() -> None:
    """The distance of unit vectors at an angle b is 2 sin(b / 2)."""
    attitude, _ = turning(1.0, np.array([0.0, 0.0, 1.0]))
    tilted = np.array([np.sin(0.5), 0.0, np.cos(0.5)])
    omega = np.array([product(product(conjugate(q), (*tilted, 0.0)), q)[:3] for q in attitude])
    np.testing.assert_allclose(axis_distances(attitude, omega, GOAL)[0], 2.0 * np.sin(0.25), atol=1e-9)


def test_two_legs_are_longer_than_the_geodesic() -> None:
    """90 degrees about x, then about y: 180 degrees of path for a rotation of 120."""
    legs = [exp((x, 0.0, 0.0)) for x in np.linspace(0.0, np.pi / 2, 50)]
    legs += [product(exp((0.0, y, 0.0)), legs[-1]) for y in np.linspace(0.0, np.pi / 2, 50)]
    assert path_ratios(np.array(legs), np.array(legs[-1]))[-1] == pytest.approx(180.0 / 120.0)


@pytest.mark.parametrize("still", [True, False])
def test_without_a_rotation_there_is_nothing_to_judge(still: bool) -> None:
    """A start at the goal, or a body that never turns, is an error and no number."""
    attitude = np.tile(GOAL if still else IDENTITY, (5, 1))
    with pytest.raises(NonFiniteError):
        axis_distances(attitude, np.full((5, 3), 0.1 * still), GOAL)
    if still:
        with pytest.raises(NonFiniteError):
            path_ratios(attitude, GOAL)


def test_tool_errors_are_those_of_the_tool() -> None:
    """A base that is off by a vector takes its tool along; a base off by an angle turns it and swings it."""
    robot = load_robot("servicer")
    q = np.concatenate([np.zeros(3), IDENTITY, robot.home])
    moved, turned = q.copy(), q.copy()
    moved[:3] = [0.3, 0.0, 0.4]
    turned[3:7] = exp((0.0, 0.0, 0.01))
    position, angle = tool_errors(robot, np.array([q, moved, turned]), np.array([q, q, q]))
    np.testing.assert_allclose(position[:2], [0.0, 0.5], atol=1e-12)
    np.testing.assert_allclose(angle, [0.0, 0.0, 0.01], atol=1e-12)
    assert 0.005 < position[2] < 0.03
