"""A URDF that cannot be used is refused with the name of the link or joint; one that can becomes the right model."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from space_robot_description.load import load_robot
from space_robot_msgs_py.errors import InertiaError, SpecError
from tests.support.description_texts import TWO_LINKS, joint, link, robot_file, urdf

LIMIT = '<limit lower="-1" upper="1" effort="7" velocity="3"/>'


def _inertial(mass: str = "2", ixx: str = "1", iyy: str = "1", izz: str = "1") -> str:
    tensor = f'<inertia ixx="{ixx}" iyy="{iyy}" izz="{izz}" ixy="0" ixz="0" iyz="0"/>'
    return f'<inertial><mass value="{mass}"/>{tensor}</inertial>'


BAD_BODIES = {
    "no inertial": ("", "no mass"),
    "zero mass": (_inertial(mass="0", ixx="0", iyy="0", izz="0"), "no mass"),
    "zero mass with inertia": (_inertial(mass="0"), "mass is not positive"),
    "negative mass": (_inertial(mass="-2"), "mass is negative; got -2.0"),
    "point mass on its axis": ('<inertial><mass value="2"/></inertial>', "mass matrix is singular"),
    "inertia without mass": (_inertial().replace('<mass value="2"/>', ""), "<inertial> has no <mass>"),
    "mass without value": (_inertial().replace("value", "vaule"), "<mass> has an attribute that is none of URDF"),
    "mass alone": (_inertial().replace(' value="2"', ""), "<mass> has no value"),
    "diagonal left out": (_inertial().replace('iyy="1" ', ""), "<inertia> has no iyy"),
    "two inertials": (_inertial() * 2, "has <inertial> 2 times"),
    "two masses": (_inertial().replace("<mass", '<mass value="1"/><mass'), "has <mass> 2 times"),
    "misspelt": (_inertial().replace("inertial", "inertail"), r"unknown element; got '<inertail>'; .*<inertial>"),
    "density": (_inertial().replace("<mass", "<density/><mass"), "unknown element in <inertial>; got '<density>'"),
    "quaternion": (_inertial().replace("<mass", '<origin quat_xyzw="0 0 0 1"/><mass'), "none of URDF 1.0"),
    "triangle": (_inertial(izz="2.1"), "triangle inequality"),
    "not positive": (_inertial(izz="-0.1"), "not positive definite"),
    "huge": (_inertial(ixx="1e308"), "inertia is beyond any spacecraft"),
    "nan mass": (_inertial(mass="nan"), "mass is not a finite number"),
    "nan inertia": (_inertial(iyy="nan"), "iyy is not a finite number"),
    "nan com": (_inertial().replace("<mass", '<origin xyz="0 nan 0"/><mass'), "xyz is not a vector"),
    "text": (_inertial(mass="heavy"), "mass is not a finite number"),
}


@pytest.mark.parametrize("case", BAD_BODIES)
def test_impossible_bodies_are_refused_by_name(case: str) -> None:
    """An impossible or missing inertia of a moving link is an InertiaError that names link and condition."""
    inside, message = BAD_BODIES[case]
    text = urdf(link("base_link"), link("upper"), link("fore", inside), *TWO_LINKS[3:])
    with pytest.raises((InertiaError, SpecError), match=message) as error:
        load_robot(robot_file(text))
    assert "link fore" in str(error.value)


def test_impossible_satellite_is_refused_by_name() -> None:
    """The satellite under a mounted arm is checked like a link."""
    with pytest.raises(InertiaError, match=r"link base_link: .*triangle"):
        load_robot(robot_file(base={"mass": 10.0, "inertia": [1.0, 1.0, 2.5]}))


def test_thin_plate_is_accepted() -> None:
    """A plate meets the triangle inequality with equality and is a possible body."""
    plate = _inertial(ixx="0.1", iyy="0.2", izz="0.3")
    assert load_robot(robot_file(urdf(link("base_link"), link("upper", plate), *TWO_LINKS[2:]))).n == 2


def test_massless_frames_on_fixed_joints_are_accepted() -> None:
    """A massless link attached by a fixed joint is a frame, also as the end of the arm."""
    robot = load_robot(robot_file(urdf(*TWO_LINKS, link("hand", ""), joint("grip", "fore", "hand", "fixed"))))
    assert robot.tool_frame == "hand"
    assert robot.body_names == ("base_link", "upper", "fore")


def test_mass_on_a_fixed_child_counts_for_the_moving_link() -> None:
    """A massless moving link whose fixed child has mass is a body with that mass."""
    text = urdf(*TWO_LINKS[:2], link("fore", ""), link("tip"), *TWO_LINKS[3:], joint("fix", "fore", "tip", "fixed"))
    assert load_robot(robot_file(text)).model.inertias[3].mass == 2.0


BAD_JOINTS = {
    "floating": (joint("j2", "upper", "fore", "floating"), "joint j2: joint type cannot be used"),
    "planar": (joint("j2", "upper", "fore", "planar"), "joint j2: joint type cannot be used"),
    "axis": (joint("j2", "upper", "fore", inside=f'{LIMIT}<axis xyz="0 0 0"/>'), "joint j2: axis has no direction"),
    "axis size": (joint("j2", "upper", "fore", inside=f'{LIMIT}<axis xyz="0 1"/>'), "joint j2: xyz is not a vector"),
    "axis nan": (joint("j2", "upper", "fore", inside=f'{LIMIT}<axis xyz="0 nan 1"/>'), "joint j2: xyz is not a vector"),
    "no limit": (
        joint("j2", "upper", "fore", inside="<axis xyz='0 0 1'/>"),
        "joint j2: revolute joint without <limit>",
    ),
    "order": (joint("j2", "upper", "fore", inside='<limit lower="1" upper="1"/>'), "joint j2: limits are not in order"),
    "nan limit": (
        joint("j2", "upper", "fore", inside='<limit lower="nan" upper="1"/>'),
        "joint j2: lower is not a number",
    ),
    "negative": (joint("j2", "upper", "fore", inside='<limit upper="1" effort="-1"/>'), "joint j2: limit is negative"),
    "unknown link": (joint("j2", "upper", "hand"), "joint j2 names an unknown link; got 'hand'"),
    "two parents": (joint("j2", "fore", "upper"), "link upper is the child of two joints"),
    "two roots": ("", "one root link"),
    "number": (
        joint("j2", "upper", "fore", inside='<limit lower="-1_0" upper="1"/>'),
        "joint j2: lower is not a number",
    ),
    "two axes": (
        joint("j2", "upper", "fore", inside=f'{LIMIT}<axis xyz="0 0 1"/><axis xyz="0 1 0"/>'),
        "<axis> 2 times",
    ),
    "limits": (joint("j2", "upper", "fore", inside=LIMIT.replace("limit", "limits")), "did you mean <limit>?"),
    "upper limit": (
        joint("j2", "upper", "fore", inside=LIMIT.replace("upper", "uper")),
        "joint j2: <limit> has an attribute that is none of URDF; got 'uper'",
    ),
    "mimic number": (
        joint("j2", "upper", "fore", inside=f'{LIMIT}<mimic joint="j1" multiplier="x"/>'),
        "joint j2: multiplier is not a number",
    ),
    "twice": (joint("j1", "upper", "fore"), "the joint name appears twice; got 'j1'"),
}


@pytest.mark.parametrize("case", BAD_JOINTS)
def test_impossible_joints_are_refused_by_name(case: str) -> None:
    """A joint that is no single coordinate of a tree is a SpecError that names it."""
    text, message = BAD_JOINTS[case]
    with pytest.raises(SpecError) as error:
        load_robot(robot_file(urdf(*TWO_LINKS[:4], text)))
    assert message in str(error.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<robot", "not valid XML"),
        ("<sdf/>", "not a URDF"),
        (urdf(link("base_link")), "no moving joint"),
        ('<robot name="x" xmlns:xacro="http://ros.org/wiki/xacro"><xacro:macro/></robot>', "xacro"),
        (urdf(link("a"), link("b"), link("c"), joint("j", "b", "c"), joint("k", "c", "b")), "joints form a loop"),
    ],
)
def test_other_texts_are_refused(text: str, message: str) -> None:
    """What is no plain URDF of a tree is refused in one line."""
    with pytest.raises(SpecError, match=message) as error:
        load_robot(robot_file(text))
    assert "\n" not in str(error.value)


def test_continuous_joint_is_one_angle_without_limits() -> None:
    """A continuous joint has one coordinate, infinite limits, and the mass matrix of a revolute one."""
    limited = load_robot(robot_file())
    free = load_robot(
        robot_file(urdf(*TWO_LINKS[:4], joint("j2", "upper", "fore", "continuous", "<axis xyz='0 0 1'/>")))
    )
    assert free.model.nq == 9
    np.testing.assert_array_equal(free.joint_lower, [-2.0, -np.inf])
    np.testing.assert_array_equal(free.model.upperPositionLimit[7:], [2.0, np.inf])
    assert free.joint_rate_limit[1] == np.inf
    q = np.concatenate([pin.neutral(free.model)[:7], [0.3, 7.0]])
    first = pin.crba(limited.model, limited.model.createData(), q)
    np.testing.assert_array_equal(first, pin.crba(free.model, free.model.createData(), q))


def test_prismatic_joints_and_branches_are_accepted() -> None:
    """A branched robot with a prismatic joint has a body per joint and keeps the limits with their joints."""
    slide = joint("a_slide", "base_link", "carriage", "prismatic", f'<axis xyz="0 2 0"/>{LIMIT}')
    robot = load_robot(robot_file(urdf(*TWO_LINKS, link("carriage"), slide)))
    limits = dict(zip(robot.joint_names, robot.joint_upper, strict=True))
    assert limits == {"a_slide": 1.0, "j1": 2.0, "j2": 2.0}
    assert dict(zip(robot.joint_names, robot.body_names[1:], strict=True))["a_slide"] == "carriage"
    assert robot.tool_frame == "fore"
    assert robot.model.joints[robot.model.getJointId("a_slide")].shortname() == "JointModelPY"


def test_foreign_elements_change_nothing() -> None:
    """Gazebo, transmission and dynamics elements are ignored: the model is the same."""
    extra = '<gazebo reference="upper"/><transmission name="t"/>'
    damped = joint("j2", "upper", "fore", inside='<dynamics damping="9" friction="3"/><axis xyz="0 0 1"/>' + LIMIT)
    robot = load_robot(robot_file(urdf(*TWO_LINKS[:4], damped, extra)))
    assert not np.any(robot.model.damping)
    assert "gazebo" not in robot.urdf
