"""The tools of two arms on lines of their own: exact, at the same time, and without moving what is not named."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from space_robot_control.references import make_reference
from space_robot_control.references.tool_kinematics import tool_pose
from space_robot_description.load import load_robot
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import ReferenceSource, Vector

SECOND = 1_000_000_000
FLYING = load_robot("dual_servicer")
FLOATING = load_robot(
    dict(FLYING.resolved)
    | {
        "base_mode": "free_floating",
        "actuators": {"joints": {}, "base_torque": {"kind": "ideal", "limit": [50, 50, 50]}},
    }
)
ROBOTS = {"flying": FLYING, "floating": FLOATING}
START: Vector = np.concatenate([[0, 0, 0, 0, 0, 0, 1.0], FLYING.home])
MOVES = {"left": [0.1, -0.1, 0.05], "right": [0.05, 0.1, -0.1]}


def _reference(mode: str, point: dict[str, Any]) -> ReferenceSource:
    return make_reference({"kind": "end_effector", "points": [{"time": 20.0, **point}]}, ROBOTS[mode], START)


@pytest.mark.parametrize("mode", ROBOTS)
def test_both_tools_are_on_their_lines_at_the_same_time(mode: str) -> None:
    """At every time both have gone the same share of their ways, to a micrometre, with their attitudes held."""
    reference = _reference(mode, {"tools": {name: {"move_by": move} for name, move in MOVES.items()}})
    robot = ROBOTS[mode]
    for time in (0, 5, 9, 13, 20, 30):
        q = reference.at(time * SECOND).q
        shares = []
        for name, move in MOVES.items():
            first, pose = tool_pose(robot, START, robot.tools[name]), tool_pose(robot, q, robot.tools[name])
            gone, way = pose.position - first.position, np.array(move)
            shares.append(float(gone @ way / (way @ way)))
            np.testing.assert_allclose(gone, shares[-1] * way, atol=1e-6)
            np.testing.assert_allclose(pose.quaternion, first.quaternion, atol=1e-6)
        assert shares[0] == pytest.approx(shares[1], abs=1e-6)
    assert shares[0] == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize("mode", ROBOTS)
@pytest.mark.parametrize(
    "point", [{"tools": {"right": {"move_by": MOVES["right"]}}}, {"tool": {"move_by": MOVES["left"]}}]
)
def test_the_arm_that_is_not_named_rests(mode: str, point: dict[str, Any]) -> None:
    """Its joints stay to the bit, also on a base that floats; ``tool`` is that of the first arm."""
    q, n = _reference(mode, point).at(20 * SECOND).q, FLYING.n // 2
    rests = slice(7, 7 + n) if "tools" in point else slice(7 + n, None)
    np.testing.assert_array_equal(q[rests], START[rests])
    assert np.abs(q[7:] - START[7:]).max() > 0.05


@pytest.mark.parametrize(
    ("point", "message"),
    [
        ({"tools": {"middle": {"move_by": [0.1, 0, 0]}}}, "no such tool"),
        ({"tools": {"left": {"move_by": [9, 0, 0]}}}, "reference.points.0.tools"),
        ({"tools": {"left": {}}, "tool": {}}, "give tool or tools"),
        ({"tools": {"left": {}}, "joints_by_deg": 3}, "give tools or joints"),
    ],
)
def test_what_two_arms_cannot_do_is_refused(point: dict[str, Any], message: str) -> None:
    """Unknown tools with the known ones, out of reach with the time, and contradictions."""
    with pytest.raises(SpecError, match=message):
        _reference("flying", point)
    with pytest.raises(SpecError, match="no such tool"):
        make_reference(
            {"kind": "end_effector", "points": [{"time": 9.0, "tools": {"left": {}}}]},
            load_robot("servicer"),
            np.concatenate([START[:7], load_robot("servicer").home]),
        )
