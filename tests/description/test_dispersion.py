"""A dispersed robot is another possible robot, the same one for the same seed, with the spread that was asked for."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from space_robot_description.dispersion import Dispersion, disperse
from space_robot_description.inertia import inertial_parameters, is_consistent
from space_robot_description.load import load_robot
from space_robot_description.robot import Robot
from space_robot_description.spec import ReactionWheels, Thrusters
from space_robot_description.validation import validate
from space_robot_msgs_py.errors import InertiaError, SpecError
from tests.support.description_texts import TWO_LINKS, link, robot_file, urdf

EVERYTHING = {
    "bodies.*.mass": 0.1,
    "bodies.*.com": 0.05,
    "bodies.*.inertia": {"uniform": 0.05},
    "joints.*.effort": 0.1,
    "joints.*.viscous": {"uniform": 0.5},
    "base_torque.torque": 0.1,
    "base_torque.momentum": 0.1,
}


def _dispersion(parameters: dict[str, Any] | None = None, **fields: Any) -> Dispersion:
    return validate(Dispersion, {"parameters": parameters or {}} | fields, "dispersion")


def _draw(robot: Robot, dispersion: Dispersion, seed: int = 1) -> Robot:
    return disperse(robot, dispersion, np.random.default_rng(seed))


def test_same_seed_same_bits_whatever_the_key_order() -> None:
    """Equal seeds give equal bits, also when the keys stand in another order in the file; other seeds do not."""
    robot = load_robot("mini")
    first = _draw(robot, _dispersion(EVERYTHING))
    second = _draw(robot, _dispersion(dict(reversed(EVERYTHING.items()))))
    assert inertial_parameters(first).tobytes() == inertial_parameters(second).tobytes()
    assert first.actuators == second.actuators
    assert first.effort_limit.tobytes() == second.effort_limit.tobytes()
    assert not np.array_equal(inertial_parameters(first), inertial_parameters(_draw(robot, _dispersion(EVERYTHING), 2)))


def test_given_robot_is_left_alone() -> None:
    """Dispersion works on a copy."""
    robot = load_robot("mini")
    before = inertial_parameters(robot)
    _draw(robot, _dispersion(EVERYTHING))
    np.testing.assert_array_equal(inertial_parameters(robot), before)


def test_no_spread_changes_no_bit() -> None:
    """An empty dispersion gives the same robot and leaves the generator where it was."""
    robot, rng = load_robot("mini"), np.random.default_rng(5)
    assert inertial_parameters(disperse(robot, _dispersion(), rng)).tobytes() == inertial_parameters(robot).tobytes()
    assert rng.random() == np.random.default_rng(5).random()


@pytest.mark.parametrize("seed", range(5))
def test_rejected_draws_leave_only_possible_bodies(seed: int) -> None:
    """With `reject` every body of every draw is physically consistent, also at eta = 0.5."""
    drawn = _draw(load_robot("mini"), _dispersion(eta=0.5), seed)
    assert all(is_consistent(row) for row in inertial_parameters(drawn))


def test_eta_is_three_standard_deviations() -> None:
    """With eta and `keep`, the ratio of drawn to nominal parameters has mean 1 and standard deviation eta / 3."""
    robot, rng = load_robot("mini"), np.random.default_rng(0)
    nominal = inertial_parameters(robot)
    dispersion = _dispersion(eta=0.3, inconsistent="keep")
    drawn = np.array([inertial_parameters(disperse(robot, dispersion, rng)) for _ in range(300)])
    ratio = drawn[:, nominal != 0.0] / nominal[nominal != 0.0]
    assert ratio.mean() == pytest.approx(1.0, abs=5 * 0.1 / np.sqrt(ratio.size))
    assert ratio.std() == pytest.approx(0.1, rel=5 / np.sqrt(2 * ratio.size))


def test_eta_may_be_a_variance() -> None:
    """With ``eta_is: variance`` a parameter is off by sqrt(eta abs(pi) / 3), whatever its sign; zero stays zero."""
    robot, rng = load_robot("mini"), np.random.default_rng(0)
    nominal = inertial_parameters(robot)
    dispersion = _dispersion(eta=0.3, eta_is="variance", inconsistent="keep")
    drawn = np.array([inertial_parameters(disperse(robot, dispersion, rng)) for _ in range(300)])
    there = nominal != 0.0
    score = (drawn - nominal)[:, there] / np.sqrt(0.1 * np.abs(nominal[there]))
    assert score.mean() == pytest.approx(0.0, abs=5 / np.sqrt(score.size))
    assert score.std() == pytest.approx(1.0, rel=5 / np.sqrt(2 * score.size))
    assert not drawn[:, ~there].any()


def test_keep_lets_impossible_bodies_pass_unchanged() -> None:
    """With `keep` the ten drawn numbers arrive as drawn, possible or not."""
    robot = load_robot("mini")
    drawn = inertial_parameters(_draw(robot, _dispersion(eta=1.5, inconsistent="keep")))
    assert not all(is_consistent(row) for row in drawn)
    factors = np.array([1 + 0.5 * rng_row for rng_row in np.random.default_rng(1).standard_normal((5, 10))])
    np.testing.assert_allclose(drawn, inertial_parameters(robot) * factors, rtol=1e-10, atol=1e-14)


def test_hopeless_rejection_ends_with_the_body_and_its_spread() -> None:
    """When no draw is possible the error names the body instead of drawing forever."""
    # A needle: its two large moments have to stay equal to nine digits.
    needle = '<mass value="1"/><inertia ixx="1e-9" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
    text = urdf(*TWO_LINKS[:2], link("fore", f"<inertial>{needle}</inertial>"), *TWO_LINKS[3:])
    with pytest.raises(
        InertiaError, match=r"link fore: no physically consistent body in 1000 draws; got 'inertia 0\.5'"
    ):
        _draw(load_robot(robot_file(text)), _dispersion({"bodies.*.inertia": 0.5}))


def test_mass_takes_the_inertia_along_and_uniform_stays_inside() -> None:
    """A mass spread scales mass and inertia alike, keeps the centre of mass, and a uniform one keeps its bounds."""
    robot, rng = load_robot("servicer"), np.random.default_rng(2)
    nominal = inertial_parameters(robot)
    dispersion = _dispersion({"bodies.*.mass": {"uniform": 0.2}})
    for _ in range(20):
        drawn = inertial_parameters(disperse(robot, dispersion, rng))
        factor = drawn[:, 0] / nominal[:, 0]
        assert np.all(np.abs(factor - 1.0) <= 0.2)
        np.testing.assert_allclose(drawn, nominal * factor[:, None], rtol=1e-12, atol=1e-12)


def test_a_name_wins_over_the_star() -> None:
    """A body named by itself gets its own spread, here none, whatever the star says."""
    robot = load_robot("mini")
    drawn = _draw(robot, _dispersion({"bodies.base_link.mass": 0.0, "bodies.*.mass": 0.1}))
    changed = inertial_parameters(drawn)[:, 0] != inertial_parameters(robot)[:, 0]
    np.testing.assert_array_equal(changed, [False, True, True, True, True])


def test_actuators_are_perturbed_together_with_their_limits() -> None:
    """Effort, wheel and thruster limits are scaled where a controller and a plant look for them."""
    drawn = _draw(load_robot("mini"), _dispersion(EVERYTHING))
    np.testing.assert_array_equal(drawn.effort_limit, drawn.actuators.joints.effort)
    assert len(set(drawn.effort_limit.tolist()) | {5.0}) == 5
    assert isinstance(drawn.actuators.base_torque, ReactionWheels)
    assert drawn.actuators.base_torque.torque not in (1.5, drawn.actuators.base_torque.momentum)
    free_flying = _draw(load_robot("ets7"), _dispersion({"base_force.limit": 0.1, "base_torque.limit": 0.1}))
    assert isinstance(free_flying.actuators.base_force, Thrusters)
    assert len({*free_flying.actuators.base_force.limit, 150.0}) == 4
    assert not free_flying.effort_limit.flags.writeable


@pytest.mark.parametrize(
    ("key", "near"),
    [
        ("bodies.antena.mass", "bodies.antenna.mass"),
        ("bodies.*.density", "bodies"),
        ("base_torque.limit", "base_torque.torque"),
        ("base_force.limit", "accepted"),
        ("mass", "accepted"),
    ],
)
def test_unknown_keys_show_the_nearest(key: str, near: str) -> None:
    """A key that names nothing of this robot is refused with the nearest keys."""
    with pytest.raises(SpecError, match=r"nothing to disperse has this name") as error:
        _draw(load_robot("mini"), _dispersion({key: 0.1}))
    assert f"dispersion.{key}" in str(error.value)
    assert near in str(error.value)


@pytest.mark.parametrize("spread", [{"normal": 0.1, "uniform": 0.1}, {}, -0.1, {"normal": -1}])
def test_spreads_are_one_non_negative_number(spread: Any) -> None:
    """A spread is a number, or exactly one of normal and uniform, never negative."""
    with pytest.raises(SpecError, match=r"dispersion parameters\.bodies"):
        _dispersion({"bodies.*.mass": spread})
