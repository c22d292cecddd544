"""References of the end effector: the tool on its line, exact derivatives, and what the arm cannot do is refused."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from space_robot_control.references import make_reference
from space_robot_control.references.tool_kinematics import tool_pose
from space_robot_description.load import load_robot
from space_robot_description.robot import Robot
from space_robot_description.rotations import from_rpy, log, relative, rotate
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import ReferenceSource, Vector

SECOND = 1_000_000_000
SERVICER, MINI = load_robot("servicer"), load_robot("mini")
CASES: list[tuple[Robot, dict[str, Any], dict[str, Any]]] = [
    (SERVICER, {"position": [0.5, 0.5, 0.5]}, {"move_by": [0.2, 0.2, 0.2]}),
    (SERVICER, {"attitude_deg": [0, 10, 20]}, {"move_by": [-0.1, 0.2, -0.2], "quaternion": [0.1, 0.2, 0.1, 1.0]}),
    (load_robot("ets7"), {"joints_by_deg": 5.0}, {"move_by": [0.1, -0.2, 0.2]}),
    (MINI, {"attitude_deg": [0, 5, 0]}, {"move_by": [0.05, 0.05, -0.05], "orientation": "free"}),
]
IDS = ["servicer_line", "servicer_turn", "ets7", "mini_position"]


def start(robot: Robot) -> Vector:
    joints = np.radians([90.0, 45.0, 45.0, 0.0]) if robot is MINI else robot.home
    return np.concatenate([[0.1, -0.2, 0.3], from_rpy((0.1, 0.2, 0.3)), joints])


def source(robot: Robot, *points: dict[str, Any], **more: Any) -> ReferenceSource:
    return make_reference({"kind": "end_effector", "points": list(points), **more}, robot, start(robot))


@pytest.mark.parametrize(("robot", "base", "tool"), CASES, ids=IDS)
def test_the_tool_follows_its_line_and_its_geodesic(robot: Robot, base: dict[str, Any], tool: dict[str, Any]) -> None:
    """At and between the knots the tool is within a nanometre and a nanoradian of the quintic line and geodesic."""
    reference = source(robot, {"time": 20.0, **base}, {"time": 50.0, "tool": tool})
    first, last = (tool_pose(robot, reference.at(t * SECOND).q) for t in (20, 50))
    np.testing.assert_allclose(last.position - first.position, tool["move_by"], atol=1e-9)
    whole = np.array(log(relative(first.quaternion, last.quaternion)))
    for t in np.linspace(20.0, 50.0, 97).tolist():
        tau = (t - 20.0) / 30.0
        share = tau**3 * (10.0 + tau * (6.0 * tau - 15.0))
        pose = tool_pose(robot, reference.at(round(t * SECOND)).q)
        np.testing.assert_allclose(pose.position, first.position + share * np.array(tool["move_by"]), atol=1e-9)
        if tool.get("orientation") != "free":
            np.testing.assert_allclose(log(relative(first.quaternion, pose.quaternion)), share * whole, atol=1e-9)
    if "quaternion" in tool:
        assert np.linalg.norm(whole) > 0.1
        asked = np.array(tool["quaternion"]) / np.linalg.norm(tool["quaternion"])
        np.testing.assert_allclose(log(relative(last.quaternion, asked)), 0.0, atol=1e-9)


@pytest.mark.parametrize(("robot", "base", "tool"), CASES, ids=IDS)
def test_velocity_and_acceleration_are_derivatives(robot: Robot, base: dict[str, Any], tool: dict[str, Any]) -> None:
    """Both are those of the configuration by central differences, and zero before, between and after the legs."""
    reference, h = source(robot, {"time": 20.0, **base}, {"time": 50.0, "tool": tool}), 100_000
    for t in (1.3, 10.0, 19.0, 22.0, 37.77, 49.0):
        stamp = round(t * SECOND)
        before, now, after = (reference.at(stamp + offset) for offset in (-h, 0, h))
        span = 2e-9 * h
        np.testing.assert_allclose((after.q[7:] - before.q[7:]) / span, now.v[6:], atol=1e-8)
        linear = np.array(rotate(now.q[3:7], now.v[:3]))
        np.testing.assert_allclose((after.q[:3] - before.q[:3]) / span, linear, atol=1e-8)
        np.testing.assert_allclose((after.v - before.v) / span, now.a, atol=1e-8)
    for stamp in (0, 20 * SECOND, 50 * SECOND, 90 * SECOND):
        resting = reference.at(stamp)
        np.testing.assert_allclose(np.concatenate([resting.v, resting.a]), 0.0, atol=1e-9)
    assert reference.at(90 * SECOND).q.tolist() == reference.at(50 * SECOND).q.tolist()


def test_the_arm_is_still_while_the_base_moves_and_the_base_while_the_tool_does() -> None:
    """Appendix C: a diagonal of the base with the arm fixed, then one of the tool with the base fixed."""
    robot, base, tool = CASES[0]
    reference = source(robot, {"time": 27.0, **base}, {"time": 57.0, "tool": tool})
    for t in range(28):
        np.testing.assert_allclose(reference.at(t * SECOND).q[7:], robot.home, atol=1e-12)
    for t in range(27, 60):
        np.testing.assert_allclose(reference.at(t * SECOND).q[:7], [0.5, 0.5, 0.5, *start(robot)[3:7]], atol=1e-12)


@pytest.mark.parametrize("robot", [SERVICER, load_robot("ets7")], ids=["servicer", "ets7"])
def test_the_tool_holds_its_pose_while_the_base_moves_and_turns(robot: Robot) -> None:
    """Station keeping: said nothing but the base's target, the tool stays within a nanometre where it is."""
    base = {"position": [0.2, -0.3, 0.4], "attitude_deg": [8.0, 5.0, 20.0]}
    reference = source(robot, {"time": 30.0, **base, "tool": {}})
    first = tool_pose(robot, reference.at(0).q)
    for t in np.linspace(0.0, 30.0, 61).tolist():
        pose = tool_pose(robot, reference.at(round(t * SECOND)).q)
        np.testing.assert_allclose(pose.position, first.position, atol=1e-9)
        np.testing.assert_allclose(log(relative(first.quaternion, pose.quaternion)), 0.0, atol=1e-9)
    np.testing.assert_allclose(reference.at(30 * SECOND).q[:3], base["position"], atol=1e-12)


def test_a_floating_base_moves_so_that_the_centre_of_mass_stays() -> None:
    """Without a force the reference keeps the centre of mass in every leg, to the accuracy of the spline."""
    robot, base, tool = CASES[3]
    reference = source(robot, {"time": 20.0, **base, "joints_by_deg": 10.0}, {"time": 50.0, "tool": tool})
    data = robot.model.createData()
    places = [np.array(pin.centerOfMass(robot.model, data, reference.at(t * SECOND).q)) for t in range(0, 60, 3)]
    assert max(np.linalg.norm(b - a) for a, b in pairwise(places)) < 1e-10
    assert np.linalg.norm(reference.at(50 * SECOND).q[:3] - start(robot)[:3]) > 1e-3


@pytest.mark.parametrize(
    ("robot", "points", "says"),
    [
        (SERVICER, [{"time": 30.0, "tool": {"move_by": [0.6, 0.6, 0.6]}}], r"points.0.tool: singular at 1\d"),
        (SERVICER, [{"time": 30.0, "tool": {"move_by": [5.0, 0, 0]}}], "points.0.tool: (singular|out of reach)"),
        (MINI, [{"time": 30.0, "tool": {"move_by": [0.1, 0, 0]}}], "4 joints cannot.*orientation: free"),
        (MINI, [{"time": 30.0, "position": [1.0, 0, 0]}], "points.0.position: the base floats freely"),
        (SERVICER, [{"time": 3.0}, {"time": 3.0}], r"points.1.time: not later.*more than 3 \[s\]"),
        (SERVICER, [{"time": 0.0}], "points.0.time: not later"),
        (SERVICER, [{"time": 3.0, "tool": {}, "joints_by_deg": 1.0}], "tool or joints, not both"),
        (SERVICER, [{"time": 3.0, "tool": {"move_by": [0, 0, 0], "position": [0, 0, 0]}}], "position or move_by"),
        (SERVICER, [{"time": 3.0, "tool": {"attitude_deg": [0, 0, 0], "orientation": "free"}}], "orientation: free"),
        (SERVICER, [], "points: not accepted"),
    ],
)
def test_an_unreachable_tool_motion_is_one_clear_error(robot: Robot, points: list[dict[str, Any]], says: str) -> None:
    """Reach, singularities, too few joints and contradictions are refused with the point and, in a run, the time."""
    with pytest.raises(SpecError, match=rf"reference.*{says}|{says}") as caught:
        source(robot, *points)
    assert "\n" not in str(caught.value)


def test_the_distance_to_singularities_can_be_chosen() -> None:
    """A bound above what the line has refuses the motion that a lower one lets pass."""
    point = {"time": 30.0, "tool": {"move_by": [0.2, 0.2, 0.2]}}
    source(SERVICER, point, smallest_singular_value=0.01)
    with pytest.raises(SpecError, match=r"singular at .*accepted: .*of 0\.5 or more"):
        source(SERVICER, point, smallest_singular_value=0.5)
