"""Several arms on one satellite: names, mounts, tools, what is refused, and the dynamics of the whole."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from space_robot_description.load import load_robot
from space_robot_description.mass_matrix import mass_matrix
from space_robot_description.payload import Payload, attach_payload
from space_robot_description.report import robot_report
from space_robot_msgs_py.errors import SpecError
from tests.support.description_texts import TWO_LINKS, joint, link, robot_file, urdf

BASE = {"mass": 300.0, "inertia": [75, 72, 78]}
LIMIT = '<axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="7" velocity="3"/>'
HAND = urdf(*TWO_LINKS, link("finger"), joint("j3", "fore", "finger", inside=f'{LIMIT}<mimic joint="j2"/>'))


def _file(**changes: Any) -> dict[str, Any]:
    left = {"urdf": urdf(*TWO_LINKS), "mount": {"xyz": [0.1, 0.5, 0.2], "rpy": [0.3, 0, 0]}}
    right = {"urdf": HAND, "mount": {"xyz": [0.1, -0.5, 0.2]}, "tool": "upper"}
    data = robot_file() | {"base": BASE, "arms": {"left": left, "right": right}} | changes
    del data["urdf"]
    return {key: value for key, value in data.items() if value is not None}


def test_every_name_of_an_arm_has_the_arms_name_in_front() -> None:
    """Joints, links, tools and followers; the robot file names them so, and the resolved file is the same robot."""
    robot = load_robot(_file(home={"right_j2": 0.3}, locked_joints={"left_j1": 0.2}))
    assert robot.joint_names == ("left_j2", "right_j1", "right_j2")
    assert robot.body_names == ("base_link", "left_fore", "right_upper", "right_fore", "right_finger")
    assert robot.tools == {"left": "left_fore", "right": "right_upper"}
    assert robot.tool_frame == "left_fore"
    assert robot.mimics["right_j3"].joint == "right_j2"
    again = load_robot(robot.resolved)
    assert (again.urdf, again.tools, again.resolved) == (robot.urdf, robot.tools, robot.resolved)


def test_each_arm_moves_as_it_would_alone() -> None:
    """With the other arm locked the mass matrix is that of the one arm on a satellite that carries the other."""
    both = load_robot("dual_servicer")
    q = np.concatenate([pin.neutral(both.model)[:7], both.home])
    whole = mass_matrix(both.model, q)
    places = dict(zip(both.joint_names, both.home.tolist(), strict=True))
    held = {name: place for name, place in places.items() if name.startswith("right")}
    homes = {name: place for name, place in places.items() if name not in held}
    spec = dict(both.resolved) | {"locked_joints": held, "home": homes}
    alone = load_robot(spec | {"actuators": dict(both.resolved["actuators"]) | {"joints": {}}})
    keep = [*range(6), *(6 + index for index, name in enumerate(both.joint_names) if name not in held)]
    found = mass_matrix(alone.model, np.concatenate([q[:7], alone.home]))
    np.testing.assert_allclose(found, whole[np.ix_(keep, keep)], rtol=0.0, atol=1e-10)


def test_payloads_and_reports_know_tools_by_name() -> None:
    """A payload at the tool of an arm changes the body that carries it; each tool has its reach."""
    robot = load_robot(_file())
    laden = attach_payload(robot, Payload(mass=2.0, frame="right"))
    before, after = (one.model.inertias.tolist()[1:] for one in (robot, laden))
    changed = [name for name, *pair in zip(robot.body_names, before, after, strict=True) if pair[0] != pair[1]]
    assert changed == ["right_upper"]
    assert set(robot_report(robot).to_dict()["tools"]) == {"left", "right"}
    assert robot_report(load_robot("mini")).tools == {}


def _pair(first: str, second: str) -> str:
    return urdf(link(first), link(second), joint(f"to_{second}", first, second))


BAD: dict[str, tuple[dict[str, Any], str]] = {
    "no urdf": ({"arms": None}, "urdf: missing; accepted: a URDF, or arms"),
    "no base": ({"base": None}, "base: missing"),
    "mount twice": ({"base": BASE | {"mount": {"xyz": [1, 0, 0]}}}, "base.mount: is of a single arm"),
    "name": ({"arms": {"left arm": {"urdf": urdf(*TWO_LINKS)}}}, "arms.left arm"),
    "tool": ({"arms": {"left": {"urdf": urdf(*TWO_LINKS), "tool": "hnad"}}}, "arms.left.tool: no such link"),
    "tools": ({"tools": {"camera": "left_eye"}}, "tools.camera: no such link"),
    "same": ({"arms": {"a": {"urdf": _pair("b_x", "y")}, "a_b": {"urdf": _pair("x", "z")}}}, "got 'a_b_x'"),
}


@pytest.mark.parametrize("case", BAD)
def test_arms_that_cannot_be_are_refused_by_key(case: str) -> None:
    """One line with the key, what is wrong, and what is accepted."""
    changes, message = BAD[case]
    with pytest.raises(SpecError) as error:
        load_robot(_file(**changes))
    assert message in str(error.value)


def test_urdf_and_arms_are_one_too_many() -> None:
    """A robot has a URDF or arms that have."""
    with pytest.raises(SpecError, match="arms have URDFs of their own"):
        load_robot(_file() | {"urdf": "arm.urdf"})
