"""Joints that mimic another one: read, chained, put behind it, and refused where they cannot be."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from space_robot_description.dispersion import Dispersion, disperse
from space_robot_description.foresight import robot_warnings
from space_robot_description.inertia import inertial_parameters
from space_robot_description.load import load_robot
from space_robot_description.mass_matrix import mass_matrix
from space_robot_description.reach import reach_of
from space_robot_description.report import robot_report
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.mimic import Mimic
from tests.support.description_texts import TWO_LINKS, joint, link, robot_file, urdf

LIMIT = '<axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="7" velocity="3"/>'
FINGERS = (link("left"), link("right"), joint("b_right", "fore", "right", inside=LIMIT))
ROBOTS = {
    "last": (joint("left", "fore", "left", inside=f'{LIMIT}<mimic joint="b_right" multiplier="-1.5" offset="0.2"/>'),),
    "first": (
        joint("a_left", "fore", "left", inside=f'{LIMIT}<mimic joint="b_right" multiplier="-1.5" offset="0.2"/>'),
    ),
}


def _mimic(name: str, of: str, **numbers: float) -> str:
    said = "".join(f' {key}="{value}"' for key, value in numbers.items())
    return joint(name, "fore", "left", inside=f'{LIMIT}<mimic joint="{of}"{said}/>')


@pytest.mark.parametrize("case", ROBOTS)
def test_a_follower_has_no_coordinate_and_stands_behind_its_master(case: str) -> None:
    """Its body is in the model, its coordinate is the master's; the names decide the order only among equals."""
    robot = load_robot(robot_file(urdf(*TWO_LINKS, *FINGERS, *ROBOTS[case])))
    assert robot.joint_names == ("j1", "j2", "b_right")
    assert robot.body_names == ("base_link", "upper", "fore", "right", "left")
    assert dict(robot.mimics) == {next(iter(robot.mimics)): Mimic("b_right", -1.5, 0.2)}
    assert (robot.model.nq, robot.model.nv, len(inertial_parameters(robot))) == (10, 9, 5)


@pytest.mark.parametrize("case", ROBOTS)
def test_mass_matrix_has_the_follower_reflected_through_its_multiplier(case: str) -> None:
    """M = G^T M_N G with the robot whose finger has a coordinate of its own."""
    robot = load_robot(robot_file(urdf(*TWO_LINKS, *FINGERS, *ROBOTS[case])))
    free = load_robot(robot_file(urdf(*TWO_LINKS, *FINGERS, joint("c_left", "fore", "left", inside=LIMIT))))
    q = np.concatenate([pin.neutral(robot.model)[:7], [0.3, -0.4, 0.6]])
    spread = np.zeros((10, 9))
    spread[:9], spread[9, 8] = np.eye(9), -1.5
    expected = spread.T @ mass_matrix(free.model, np.append(q, -1.5 * 0.6 + 0.2)) @ spread
    np.testing.assert_allclose(mass_matrix(robot.model, q), expected, rtol=0.0, atol=1e-13)


def test_the_model_is_the_one_that_pinocchio_reads() -> None:
    """Pinocchio's own reader of mimic gives the same mass matrix and forces for the shipped gripper."""
    robot = load_robot("panda_gripper")
    model = pin.buildModelFromXML(robot.urdf, pin.JointModelFreeFlyer(), mimic=True)
    model.gravity.setZero()
    assert tuple(model.names[2:]) == (*robot.joint_names, "panda_finger_joint2")
    q = np.concatenate([pin.neutral(model)[:7], robot.home])
    v, a = np.random.default_rng(1).normal(size=(2, 14))
    data, own = model.createData(), robot.model.createData()
    np.testing.assert_allclose(
        pin.rnea(robot.model, own, q, v, a), pin.rnea(model, data, q, v, a), rtol=0.0, atol=1e-11
    )


def test_a_follower_of_a_follower_follows_the_first_of_the_chain() -> None:
    """m1 (m2 q + o2) + o1, in whatever order they are written; one that does not move is fixed where it stands."""
    chain = joint("a", "left", "tip", inside=f'{LIMIT}<mimic joint="left" multiplier="2" offset="0.1"/>')
    still = joint("s", "left", "still", inside=f'{LIMIT}<mimic joint="left" multiplier="0" offset="0.3"/>')
    text = urdf(*TWO_LINKS, *FINGERS, link("tip"), link("still"), chain, still, *ROBOTS["last"])
    robot = load_robot(robot_file(text))
    assert robot.mimics["a"] == Mimic("b_right", -3.0, pytest.approx(0.5))
    assert set(robot.mimics) == {"a", "left"}
    again = load_robot(robot.resolved)
    assert again.mimics == robot.mimics
    assert again.joint_names == robot.joint_names


BAD = {
    "unknown": (
        _mimic("left", "b_rihgt"),
        "joint left: mimics a joint that is not there; got 'b_rihgt'; accepted: b_right",
    ),
    "itself": (_mimic("left", "left"), "joint left: mimics itself; got 'left -> left'"),
    "circle": (
        _mimic("left", "x") + link("x") + joint("x", "left", "x", inside=f'{LIMIT}<mimic joint="left"/>'),
        "joint left: mimics itself; got 'left -> x -> left'",
    ),
    "carried": (
        _mimic("left", "x") + link("x") + joint("x", "left", "x", inside=LIMIT),
        "joint left: mimics x, which it carries",
    ),
    "nameless": (_mimic("left", ""), "joint left: mimics a joint without a name"),
    "number": (_mimic("left", "j2", multiplier=float("nan")), "joint left: multiplier is not a number"),
}


@pytest.mark.parametrize("case", BAD)
def test_what_cannot_be_followed_is_refused_by_name(case: str) -> None:
    """One line with the joint, what it says it follows, and what it may."""
    text, message = BAD[case]
    with pytest.raises(SpecError) as error:
        load_robot(robot_file(urdf(*TWO_LINKS, *FINGERS, text)))
    assert message in str(error.value)


def test_a_follower_that_leaves_its_own_limits_is_warned_of() -> None:
    """Only the limits of the master hold; where they take the follower beyond its own ones, ``robot`` says so."""
    warnings = robot_warnings(load_robot(robot_file(urdf(*TWO_LINKS, *FINGERS, *ROBOTS["last"]))))
    assert any("joint left follows b_right from -1.3 to 1.7, and its own limits are -1 to 1" in one for one in warnings)
    narrow = {"b_right": {"lower": -0.5, "upper": 0.5}}
    robot = load_robot(robot_file(urdf(*TWO_LINKS, *FINGERS, *ROBOTS["last"]), joint_limits=narrow))
    assert not any("follows" in one for one in robot_warnings(robot))


def test_reports_reach_and_dispersion_know_followers() -> None:
    """A tool on a follower has a reach, its body a row and a deviation, the follower a line and no joint row."""
    robot = load_robot(robot_file(urdf(*TWO_LINKS, *FINGERS, *ROBOTS["first"]), tool="left"))
    report = robot_report(robot)
    assert [row.body for row in report.joints] == ["upper", "fore", "right"]
    assert report.followers == {"a_left": {"joint": "b_right", "multiplier": -1.5, "offset": 0.2}}
    assert reach_of(robot).sampled == pytest.approx(0.8)
    drawn = disperse(robot, Dispersion(parameters={"bodies.left.mass": 0.1}), np.random.default_rng(1))
    changed = inertial_parameters(drawn)[:, 0] != inertial_parameters(robot)[:, 0]
    assert changed.tolist() == [False, False, False, False, True]
