"""A live reference interpolates as joint_trajectory_controller does, and is never moved by what cannot be done."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from space_robot_control.references.base_path import BaseMotion, body_rates, path_to
from space_robot_control.references.joint_path import JointPath, JointPoint
from space_robot_control.references.live import LiveReference
from space_robot_control.references.spec import LiveSpec
from space_robot_control.references.tool_kinematics import tool_pose
from space_robot_control.references.trajectory import Trajectory, TrajectoryPoint
from space_robot_description import rotations as rot
from space_robot_description.load import load_robot
from space_robot_msgs_py.errors import SpaceRobotError
from space_robot_msgs_py.interfaces import NANOSECONDS, Reference, Vector

PERIOD, STEPS = 100_000_000, 2000
UR5 = load_robot("ur5_sat")
HOME = np.array((0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.2, 1.6, -0.4, 1.2, 0.0))
STILL = [0.0] * 6


def live(**changes: Any) -> LiveReference:
    """A reference of the UR5 that has given out its first stamps."""
    made = LiveReference(LiveSpec(**changes), UR5, HOME, period=PERIOD, steps=STEPS)
    run(made, 2)
    return made


def run(reference: LiveReference, ticks: int) -> list[Reference]:
    """That many more references; the first two of a run begin at stamp 0."""
    begin = reference.now + PERIOD if reference.now or getattr(reference, "begun", False) else 0
    reference.begun = True  # type: ignore[attr-defined]
    return [reference.at(begin + k * PERIOD) for k in range(ticks)]


def point(seconds: float, positions: Vector, *further: Any) -> TrajectoryPoint:
    """A point of a trajectory."""
    return TrajectoryPoint(round(seconds * NANOSECONDS), positions.tolist(), *further)


def check_derivatives(references: list[Reference], *, smooth: bool = True) -> None:
    """The rates are those of the configurations, and the accelerations those of smooth rates, to second order."""
    seconds = PERIOD / NANOSECONDS
    for before, after in pairwise(references):
        turn = np.array(rot.log(rot.relative(before.q[3:7], after.q[3:7])))
        moved = np.concatenate((turn, after.q[7:] - before.q[7:]))
        np.testing.assert_allclose(moved / seconds, 0.5 * (before.v + after.v)[3:], atol=5e-4 if smooth else 2e-3)
        if not smooth:
            continue
        np.testing.assert_allclose((after.v - before.v)[3:] / seconds, 0.5 * (before.a + after.a)[3:], atol=8e-3)


def test_nothing_comes_and_nothing_moves() -> None:
    """Without set-points it stays in the initial configuration."""
    for reference in run(live(), 5):
        assert np.array_equal(reference.q, HOME)
        assert not reference.v.any()
        assert not reference.a.any()


def test_pieces_are_what_their_ends_say() -> None:
    """Linear without velocities, cubic with, quintic with accelerations too; ends are met with their derivatives."""
    x, v, a = np.array((1.0, -2.0)), np.array((0.3, 0.1)), np.array((-0.2, 0.5))
    first = JointPoint(0, np.zeros(2), v, a)
    straight = JointPath([first, JointPoint(2 * NANOSECONDS, x)])
    assert straight.at(NANOSECONDS)[:2] == ([0.5, -1.0], [0.5, -1.0])
    for last in (JointPoint(2 * NANOSECONDS, x, v), JointPoint(2 * NANOSECONDS, x, v, a)):
        path = JointPath([first, last])
        ends = [path.at(0), path.at(2 * NANOSECONDS - 1)]
        np.testing.assert_allclose([end[0] for end in ends], [np.zeros(2), x], atol=1e-8)
        np.testing.assert_allclose([end[1] for end in ends], [v, v], atol=1e-8)
        if last.acceleration is not None:
            np.testing.assert_allclose([end[2] for end in ends], [a, a], atol=1e-7)
        stamps = list(range(0, 3 * NANOSECONDS, 99_999_999))
        np.testing.assert_allclose(path.positions(stamps), [path.at(stamp)[0] for stamp in stamps], atol=1e-14)


def test_a_trajectory_is_followed_by_name_and_then_held() -> None:
    """Joints in any order, others stay; it starts where the reference is and rests in its last point."""
    reference, names = live(), ["wrist_3_joint", "shoulder_pan_joint"]
    goal = np.array((0.3, -0.2))
    end = reference.follow(Trajectory(names, [point(1.0, 0.5 * goal, (0.1, -0.1)), point(2.0, goal, (0.0, 0.0))]))
    assert end == reference.now + 2 * NANOSECONDS
    references = run(reference, 30)
    check_derivatives(references, smooth=False)
    assert references[9].q[7:].tolist() == pytest.approx([-0.1, *HOME[8:12], 0.15])
    assert references[-1].q[7:].tolist() == [-0.2, *HOME[8:12], 0.3]
    assert reference.doing == "at rest"


def test_a_trajectory_that_began_is_joined_where_it_is() -> None:
    """With a stamp it is a function of the time of the run; what is past of it is left out."""
    reference = live()
    run(reference, 10)
    trajectory = Trajectory(
        ["wrist_3_joint"], [point(0.0, np.zeros(1)), point(2.0, 0.2 * np.ones(1))], stamp=500_000_000
    )
    reference.follow(trajectory)
    stamp = reference.now + PERIOD
    assert run(reference, 1)[0].q[12] == pytest.approx(0.1 * (stamp / NANOSECONDS - 0.5))


def test_a_later_trajectory_takes_over_smoothly() -> None:
    """It starts with position, velocity and acceleration of the reference that it finds."""
    reference = live()
    reference.follow(Trajectory(UR5.joint_names, [point(3.0, HOME[7:] + 0.2, STILL, STILL)]))
    references = run(reference, 15)
    reference.follow(Trajectory(UR5.joint_names, [point(4.0, HOME[7:] - 0.1, STILL, STILL)]))
    references += run(reference, 45)
    check_derivatives(references)
    np.testing.assert_allclose(references[-1].q[7:], HOME[7:] - 0.1, atol=1e-12)


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ({"names": ["elbow"]}, "elbow_joint"),
        ({"names": ["elbow_joint"] * 2}, "each once"),
        ({"names": []}, "each once"),
        ({"points": []}, "1 to 10000 points"),
        ({"points": [TrajectoryPoint(NANOSECONDS, [float("nan")])]}, "finite"),
        ({"points": [TrajectoryPoint(NANOSECONDS, [0.0, 0.0])]}, "wrong size"),
        ({"points": [TrajectoryPoint(NANOSECONDS, [])]}, "wrong size"),
        ({"points": [TrajectoryPoint(NANOSECONDS, [1e9])]}, "too large"),
        ({"points": [TrajectoryPoint(NANOSECONDS, [9.0])]}, "outside the joint's limits"),
        ({"points": [TrajectoryPoint(NANOSECONDS // 10, [1.0])]}, "too fast"),
        ({"points": [TrajectoryPoint(-1, [1.0])]}, "times do not increase"),
        ({"points": [TrajectoryPoint(NANOSECONDS, [1.5])] * 2}, r"points\.1\.time_from_start"),
        ({"points": [TrajectoryPoint(NANOSECONDS, [1.5], [0.1])]}, "does not end at rest"),
        ({"stamp": 1_700_000_000 * NANOSECONDS}, "not in this run"),
    ],
)
def test_what_cannot_be_followed_changes_nothing(change: dict[str, Any], why: str) -> None:
    """Names, numbers, times, limits: the reason names the field, and the trajectory before is followed on."""
    reference, same = live(), live()
    for one in (reference, same):
        one.follow(Trajectory(["elbow_joint"], [point(1.0, np.array([1.5]))]))
    bad = replace(Trajectory(["elbow_joint"], [point(1.0, np.array([1.4]))]), **change)
    with pytest.raises(SpaceRobotError, match=why):
        reference.follow(bad)
    for got, expected in zip(run(reference, 20), run(same, 20), strict=True):
        assert np.array_equal(got.q, expected.q)


def test_the_base_goes_to_its_goal_at_a_bounded_speed_and_another_goal_takes_over() -> None:
    """Both goals are smooth to the second derivative, no faster than the limits, and the second one is met exactly."""
    reference = live(base_rate_deg=2.0)
    reference.go_to((0.0, 0.0, 0.0), (0.1, 0.0, 0.0, 1.0))
    references = run(reference, 40)
    assert reference.doing == "base/goal"
    reference.go_to((0.0, 0.0, 0.0), (0.0, 0.1, 0.05, 1.0))
    references += run(reference, 200)
    check_derivatives(references)
    assert max(float(np.linalg.norm(one.v[3:6])) for one in references) <= 1.02 * np.radians(2.0)
    turned = rot.relative(references[-1].q[3:7], rot.normalized((0.0, 0.1, 0.05, 1.0)))
    assert float(np.linalg.norm(rot.log(turned))) < 1e-12
    assert reference.doing == "at rest"


def test_a_moving_base_is_brought_to_rest_from_any_state() -> None:
    """Position, velocity and acceleration are met at the start, and rest at the end."""
    first = BaseMotion((0.1, 0.2, 0.3), (0.0, 0.0, 0.0, 1.0), (0.01, 0.0, 0.0), (0.0, 0.01, 0.0), (0.0, 0.002, 0.0))
    path = path_to(first, (0.2, 0.2, 0.3), (0.0, 0.0, 0.0, 1.0), 5, 0.02, 0.02)
    begin, last = path.at(5), path.at(path.end)
    np.testing.assert_allclose((*begin.position, *begin.velocity), (*first.position, *first.velocity), atol=1e-12)
    np.testing.assert_allclose((*begin.rate, *begin.acceleration), (*first.rate, *first.acceleration), atol=1e-12)
    assert last.position == [0.2, 0.2, 0.3]
    assert not any((*last.velocity, *last.rate))


@pytest.mark.parametrize("size", [0.0, 1e-5, 0.009, 0.011, 1.0, 3.0])
def test_body_rates_are_derivatives(size: float) -> None:
    """Of the attitude, and of the rate, at angles where the series holds and where it does not."""
    direction, d, dd = np.array((0.6, 0.0, 0.8)), np.array((0.3, -0.2, 0.5)), np.array((-0.1, 0.4, 0.2))
    h = 1e-4

    def at(t: float) -> Vector:
        return size * direction + t * d + 0.5 * t * t * dd

    rate, change = body_rates(at(0.0), d, dd)
    step = np.array(rot.log(rot.relative(rot.exp(at(-h)), rot.exp(at(h)))))
    np.testing.assert_allclose(step / (2 * h), rate, atol=1e-6)
    after, before = (body_rates(at(t), d + t * dd, dd)[0] for t in (h, -h))
    np.testing.assert_allclose((after - before) / (2 * h), change, atol=1e-6)


def test_the_tool_goes_straight_to_its_goal() -> None:
    """It ends in the pose, on the line, while the base keeps its attitude; meanwhile other goals are refused."""
    reference = live(tool_speed=0.01)
    start = tool_pose(UR5, HOME)
    goal = start.position + np.array((0.02, 0.03, -0.02))
    reference.bring_tool(goal, start.quaternion)
    assert reference.doing == "tool/goal"
    with pytest.raises(SpaceRobotError, match="the tool moves the robot"):
        reference.go_to((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))
    references = run(reference, 90)
    check_derivatives(references)
    way = goal - start.position
    for one in references:
        moved = tool_pose(UR5, one.q).position - start.position
        np.testing.assert_allclose(np.cross(moved, way), 0.0, atol=1e-9)
        np.testing.assert_allclose(one.q[3:7], HOME[3:7], atol=1e-12)
    np.testing.assert_allclose(tool_pose(UR5, references[-1].q).position, goal, atol=1e-9)
    assert reference.doing == "at rest"


@pytest.mark.parametrize(
    ("position", "quaternion", "why"),
    [
        ((5.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), r"tool/goal.*(out of reach|singular)"),
        ((0.1, float("inf"), 0.0), (0.0, 0.0, 0.0, 1.0), "finite"),
        ((1e9, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), "too far"),
        ((0.1, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0), "not a rotation"),
    ],
)
def test_a_pose_that_cannot_be_taken_is_refused(position: Any, quaternion: Any, why: str) -> None:
    """Out of reach, not finite, no rotation."""
    reference = live()
    with pytest.raises(SpaceRobotError, match=why):
        reference.bring_tool(position, quaternion)
    assert reference.doing == "at rest"
    if why != r"tool/goal.*(out of reach|singular)":
        with pytest.raises(SpaceRobotError, match=why):
            reference.go_to(position, quaternion)


def test_the_tool_moves_by_hand_and_stops_when_the_hand_is_gone() -> None:
    """It reaches the speed that is said within the ramp; without a message it rests, and others may move it."""
    reference = live(teleop_timeout=0.3, teleop_ramp=0.5)
    references = []
    for _ in range(20):
        reference.move_tool((0.0, 0.0, 0.02, 0.0, 0.0, 0.0))
        references += run(reference, 1)
    assert reference.doing == "teleop"
    first, last = (tool_pose(UR5, one.q) for one in references[-2:])
    speed = np.array(rot.rotate_inverse(first.quaternion, last.position - first.position)) / (PERIOD / NANOSECONDS)
    np.testing.assert_allclose(speed, (0.0, 0.0, 0.02), atol=2e-4)
    references += run(reference, 10)
    check_derivatives(references, smooth=False)
    assert not references[-1].v.any()
    assert reference.doing == "at rest"
    reference.follow(Trajectory(UR5.joint_names, [point(3.0, HOME[7:])]))


def test_the_hand_is_not_faster_than_the_limits_and_stops_at_them() -> None:
    """A twist is scaled down; where a joint would leave its limits the arm stands still and says so."""
    reference = live(tool_speed=0.01)
    for _ in range(30):
        reference.move_tool((1e308, 0.0, 1e308, 0.0, 0.0, 0.0))
        one = run(reference, 1)[0]
    assert np.isfinite(one.v).all()
    short = replace(UR5, joint_upper=HOME[7:] + 0.02)
    reference = LiveReference(LiveSpec(), short, HOME, period=PERIOD, steps=STEPS)
    said = []
    for k in range(100):
        reference.move_tool((0.0, 0.03, 0.03, 0.0, 0.0, 0.0))
        assert (reference.at(k * PERIOD).q[7:] <= short.joint_upper + 1e-4).all()
        said.append(reference.doing)
    assert any("is at its limit" in one for one in said)


def test_a_reset_forgets_everything() -> None:
    """Time begins again, in the initial configuration."""
    reference = live()
    reference.follow(Trajectory(["elbow_joint"], [point(1.0, np.array([1.4]))]))
    run(reference, 5)
    reference.reset()
    assert np.array_equal(reference.at(0).q, HOME)
    assert reference.doing == "at rest"
