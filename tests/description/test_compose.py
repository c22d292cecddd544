"""A robot file becomes one whole robot: mounted, locked, limited, actuated, and the same again from its own content."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from space_robot_description.inertia import inertial_parameters
from space_robot_description.load import load_robot
from space_robot_description.robot import Robot
from space_robot_description.share import resource, shipped
from space_robot_msgs_py.errors import InputFileError, NonFiniteError, SpecError
from tests.support.description_texts import TWO_LINKS, actuators, joint, link, robot_file, urdf

WHEELS = {"kind": "reaction_wheels", "torque": 1.0, "momentum": 2.0}
THRUSTERS = {"kind": "thrusters", "limit": [1, 1, 1]}
BASE = {"mass": 50.0, "inertia": [3.0, 4.0, 5.0, 0.1, 0.2, 0.3], "com": [0.1, 0.0, -0.2]}
ARMS = {
    "ur5_sat": ("ur_description/urdf/ur5_robot.urdf", {}),
    "panda_sat": ("panda_description/urdf/panda.urdf", {"panda_finger_joint1": 0.02, "panda_finger_joint2": 0.02}),
}

# Cylinders of 0.06 m radius and 0.12 m length, which the robot file has instead of the URDF's of 0.6 m radius.
WRISTS = {
    f"wrist_{number}_joint": [mass * (3 * 0.06**2 + 0.12**2) / 12] * 2 + [mass * 0.06**2 / 2]
    for number, mass in ((1, 1.219), (2, 1.219), (3, 0.1879))
}


def _bare_arm(name: str) -> Any:
    """The wheel's own URDF, fixed base, built by Pinocchio alone."""
    path, locked = ARMS[name]
    full = pin.buildModelFromUrdf(str(resource(f"example-robot-data:{path}", Path())))
    full.gravity.setZero()
    for joint_name, moments in WRISTS.items() if name == "ur5_sat" else ():
        full.inertias[full.getJointId(joint_name)].inertia = np.diag(moments)
    q = pin.neutral(full)
    for joint_name, position in locked.items():
        q[full.joints[full.getJointId(joint_name)].idx_q] = position
    return pin.buildReducedModel(full, [full.getJointId(joint_name) for joint_name in locked], q)


def _mass_matrix(model: Any, q: Any) -> Any:
    upper = np.triu(pin.crba(model, model.createData(), q))
    return upper + np.triu(upper, 1).T


@pytest.mark.parametrize("name", ARMS)
@pytest.mark.parametrize("seed", range(3))
def test_mounted_arm_keeps_its_dynamics(name: str, seed: int) -> None:
    """The arm block of the composed mass matrix is the mass matrix of the third-party arm on a fixed base."""
    robot, arm = load_robot(name), _bare_arm(name)
    assert tuple(arm.names)[1:] == robot.joint_names
    q = np.random.default_rng(seed).uniform(-1.5, 1.5, robot.n)
    whole = _mass_matrix(robot.model, np.concatenate([pin.neutral(robot.model)[:7], q]))
    np.testing.assert_allclose(whole[6:, 6:], _mass_matrix(arm, q), rtol=0, atol=1e-12)


@pytest.mark.parametrize("name", ARMS)
def test_mounted_arm_stands_on_the_satellite(name: str) -> None:
    """The base body is satellite plus the arm's root link at the mount, and the total mass is the sum."""
    robot, arm = load_robot(name), _bare_arm(name)
    placements = {"ur5_sat": [0.3, 0, 0.6], "panda_sat": [0.25, 0, 0.6]}
    tensors = {
        "ur5_sat": np.diag([75.0, 72.0, 78.0]),
        "panda_sat": np.array([[75.0, 0.8, -0.5], [0.8, 72.0, 0.3], [-0.5, 0.3, 78.0]]),
    }
    coms = {"ur5_sat": [0, 0, -0.05], "panda_sat": [0, 0, 0]}
    mount = pin.SE3(np.eye(3), np.array(placements[name]))
    base = pin.Inertia(300.0, np.array(coms[name]), tensors[name]) + mount.act(arm.inertias[0])
    np.testing.assert_allclose(inertial_parameters(robot)[0], base.toDynamicParameters(), atol=1e-12)
    assert inertial_parameters(robot)[:, 0].sum() == pytest.approx(300.0 + sum(i.mass for i in arm.inertias), rel=1e-14)


def test_locked_joint_stands_where_the_moving_one_would() -> None:
    """Locking a joint gives the dynamics of the robot with that joint held at the position."""
    whole = load_robot(robot_file())
    locked = load_robot(robot_file(locked_joints={"j1": 0.7}))
    base = pin.neutral(whole.model)[:7]
    keep = [0, 1, 2, 3, 4, 5, 7]
    expected = _mass_matrix(whole.model, np.concatenate([base, [0.7, -0.4]]))[np.ix_(keep, keep)]
    actual = _mass_matrix(locked.model, np.concatenate([base, [-0.4]]))
    np.testing.assert_allclose(actual, expected, atol=1e-14)


def test_follower_of_a_locked_joint_is_locked_with_it() -> None:
    """A joint that mimics a locked one stands at multiplier times its position plus offset."""
    limit = '<axis xyz="0 0 1"/><limit lower="-2" upper="2"/>'
    parts = [link("finger"), joint("j3", "fore", "finger", inside=limit)]
    mimic = joint("j3", "fore", "finger", inside=f'{limit}<mimic joint="j2" multiplier="-2" offset="0.1"/>')
    expected = load_robot(robot_file(urdf(*TWO_LINKS, *parts), locked_joints={"j2": 0.3, "j3": -0.5}))
    actual = load_robot(robot_file(urdf(*TWO_LINKS, parts[0], mimic), locked_joints={"j2": 0.3}))
    assert actual.joint_names == ("j1",)
    np.testing.assert_allclose(inertial_parameters(actual), inertial_parameters(expected), atol=1e-15)


def test_followers_of_followers_are_locked_too() -> None:
    """A joint that mimics one that mimics a locked one stands where both say, in whatever order they are written."""
    limit = '<axis xyz="0 0 1"/><limit lower="-2" upper="2"/>'
    first = joint("j3", "fore", "finger", inside=f'{limit}<mimic joint="j4" multiplier="0.5"/>')
    second = joint("j4", "fore", "thumb", inside=f'{limit}<mimic joint="j2" multiplier="-2" offset="0.1"/>')
    links = (link("finger"), link("thumb"))
    plain = [joint(name, "fore", child, inside=limit) for name, child in (("j3", "finger"), ("j4", "thumb"))]
    expected = load_robot(
        robot_file(urdf(*TWO_LINKS, *links, *plain), locked_joints={"j2": 0.3, "j3": -0.25, "j4": -0.5})
    )
    actual = load_robot(robot_file(urdf(*TWO_LINKS, *links, first, second), locked_joints={"j2": 0.3}))
    assert actual.joint_names == ("j1",)
    np.testing.assert_allclose(inertial_parameters(actual), inertial_parameters(expected), atol=1e-15)


def test_home_that_is_not_said_is_the_nearest_position_inside() -> None:
    """A joint that cannot stand at 0 stands at the limit nearest to it, unless the file says where."""
    limits = {"j1": {"lower": 0.5}, "j2": {"upper": -0.25}}
    np.testing.assert_array_equal(load_robot(robot_file(joint_limits=limits)).home, [0.5, -0.25])
    said = load_robot(robot_file(joint_limits=limits, home={"j1": 1.0}))
    np.testing.assert_array_equal(said.home, [1.0, -0.25])
    np.testing.assert_array_equal(load_robot(said.resolved).home, said.home)


def test_limits_of_the_robot_file_stand_in_for_those_of_the_urdf() -> None:
    """A joint without usable limits is refused with the key that gives it some, and the key does."""
    for inside in ('<limit effort="1"/>', "<axis xyz='0 0 1'/>"):
        text = urdf(*TWO_LINKS[:4], joint("j2", "upper", "fore", inside=inside))
        with pytest.raises(SpecError, match=r"joint j2: .*joint_limits: \{j2: \{lower: -1\.5, upper: 1\.5\}\}"):
            load_robot(robot_file(text))
        robot = load_robot(robot_file(text, joint_limits={"j2": {"lower": -1.5, "upper": 1.5}}))
        np.testing.assert_array_equal(robot.joint_upper, [2.0, 1.5])


def test_names_change_only_on_collision() -> None:
    """The arm's own base_link gets a prefix, every other link and joint keeps its name."""
    robot = load_robot(robot_file(base=BASE))
    names = [element.get("name") for element in ET.fromstring(robot.urdf).iter("link")]
    assert names == ["base_link", "arm_base_link", "upper", "fore"]
    assert robot.joint_names == ("j1", "j2")


def test_root_of_a_whole_robot_becomes_base_link() -> None:
    """A whole robot's root link is called base_link whatever the URDF calls it."""
    text = urdf(link("hull"), link("base_link"), joint("j1", "hull", "base_link"))
    robot = load_robot(robot_file(text))
    assert robot.body_names == ("base_link", "robot_base_link")


def test_limits_and_home_of_the_file_win() -> None:
    """Joint limits, efforts and home of the robot file override the URDF joint by joint."""
    changes = {"joint_limits": {"j2": {"lower": -0.5, "velocity": 0.1}}, "home": {"j2": 0.25}}
    robot = load_robot(robot_file(**changes, actuators=actuators(joints={"effort": {"j1": 3.0}, "lag": [0.1, 0.2]})))
    np.testing.assert_array_equal(robot.joint_lower, [-2.0, -0.5])
    np.testing.assert_array_equal(robot.joint_upper, [2.0, 2.0])
    np.testing.assert_array_equal(robot.joint_rate_limit, [3.0, 0.1])
    np.testing.assert_array_equal(robot.effort_limit, [3.0, 7.0])
    np.testing.assert_array_equal(robot.home, [0.0, 0.25])
    assert robot.actuators.joints.lag == (0.1, 0.2)


def test_relative_meshes_become_absolute_and_packages_stay(tmp_path: Path) -> None:
    """A relative mesh is found from anywhere, a package:// one is left to ROS."""
    meshes = '<visual><geometry><mesh filename="{}"/></geometry></visual>'
    inside = (
        meshes.format("m/a.stl") + meshes.format("package://p/b.stl") + TWO_LINKS[2].removeprefix('<link name="fore">')
    )
    text = urdf(*TWO_LINKS[:2], f'<link name="fore">{inside}', *TWO_LINKS[3:])
    (tmp_path / "arm.urdf").write_text(text)
    (tmp_path / "robot.yaml").write_text(json.dumps(robot_file("arm.urdf")))
    robot = load_robot(tmp_path / "robot.yaml")
    names = [mesh.get("filename") for mesh in ET.fromstring(robot.urdf).iter("mesh")]
    assert names == [(tmp_path / "m/a.stl").resolve().as_uri(), "package://p/b.stl"]


def _same(first: Robot, second: Robot) -> bool:
    values = ("effort_limit", "joint_lower", "joint_upper", "joint_rate_limit", "home")
    equal = all(getattr(first, name).tobytes() == getattr(second, name).tobytes() for name in values)
    placements = zip(first.model.jointPlacements, second.model.jointPlacements, strict=True)
    equal &= all(a.homogeneous.tobytes() == b.homogeneous.tobytes() for a, b in placements)
    return equal and inertial_parameters(first).tobytes() == inertial_parameters(second).tobytes()


@pytest.mark.parametrize("name", shipped("robots"))
def test_resolved_content_makes_the_same_bits(name: str) -> None:
    """A robot made again from its resolved content, through JSON, is the same robot bit for bit."""
    robot = load_robot(name)
    again = load_robot(json.loads(json.dumps(robot.resolved, allow_nan=False)))
    assert again.urdf == robot.urdf
    assert again.resolved == robot.resolved
    assert again.actuators == robot.actuators
    assert again.joint_names == robot.joint_names
    assert again.tool_frame == robot.tool_frame
    assert _same(robot, again)


@given(position=st.floats(-3, 3), rpy=st.tuples(*[st.floats(-3, 3)] * 3), xyz=st.tuples(*[st.floats(-3, 3)] * 3))
@settings(max_examples=25, deadline=None)
def test_resolving_is_stable_for_any_mount_and_lock(position: float, rpy: tuple[float], xyz: tuple[float]) -> None:
    """Whatever the mount and the locked position, resolved content makes the same bits."""
    base = BASE | {"mount": {"xyz": list(xyz), "rpy": list(rpy)}}
    robot = load_robot(robot_file(base=base, locked_joints={"j1": position}))
    assert _same(robot, load_robot(robot.resolved))


BAD_FILES: dict[str, tuple[dict[str, Any], str]] = {
    "free-flying without thrusters": (
        {"base_mode": "free_flying"},
        "actuators.base_force: free_flying needs thrusters",
    ),
    "floating with thrusters": ({"actuators": actuators(base_force=THRUSTERS)}, "free_floating has no thrusters"),
    "flat wheels": (
        {"actuators": actuators(base_torque=WHEELS | {"axes": [[1, 0, 0], [0, 1, 0], [1, 1, 0]]})},
        "actuators.base_torque.axes: wheel axes do not span three dimensions",
    ),
    "zero axis": (
        {"actuators": actuators(base_torque=WHEELS | {"axes": [[1, 0, 0], [0, 1, 0], [0, 0, 0]]})},
        "actuators.base_torque.axes.2: wheel axis has no direction",
    ),
    "wheel momentum": (
        {"actuators": actuators(base_torque=WHEELS | {"momentum": 0})},
        "robot actuators.base_torque.momentum: not accepted; got 0; accepted: a number greater than 0",
    ),
    "initial momentum": (
        {"actuators": actuators(base_torque=WHEELS | {"initial_momentum": [0, 0]})},
        "actuators.base_torque.initial_momentum: one value per wheel",
    ),
    "too much momentum": (
        {"actuators": actuators(base_torque=WHEELS | {"initial_momentum": [0, -2.5, 0]})},
        "actuators.base_torque.initial_momentum: beyond the momentum limit",
    ),
    "thrusters without torque": (
        {"actuators": actuators(base_torque=WHEELS | {"unloading": [0.5, 0.0, 0.7]})},
        "actuators.base_torque.unloading: is not positive",
    ),
    "negative thrust": (
        {"base_mode": "free_flying", "actuators": actuators(base_force=THRUSTERS | {"limit": [1, -1, 1]})},
        "actuators.base_force.limit: limit is negative",
    ),
    "pulse without pwm": (
        {"base_mode": "free_flying", "actuators": actuators(base_force=THRUSTERS | {"minimum_pulse": 0.1})},
        "actuators.base_force.minimum_pulse: only pulsed",
    ),
    "efforts": (
        {"actuators": actuators(joints={"effort": [1, 2, 3]})},
        "actuators.joints.effort: wrong number of values; got 3; accepted: 2, for j1, j2",
    ),
    "no effort": (
        {"actuators": actuators(joints={"effort": 0})},
        "actuators.joints.effort.j1: the joint has no effort",
    ),
    "negative lag": ({"actuators": actuators(joints={"lag": -1})}, "actuators.joints.lag.j1: is negative; got -1.0"),
    "unknown motor": (
        {"actuators": actuators(joints={"effort": {"j3": 1}})},
        "actuators.joints.effort: no such joint; got 'j3'; accepted: j",
    ),
    "unknown home": ({"home": {"J1": 0.1}}, "home: no such joint; got 'J1'"),
    "unknown lock": ({"locked_joints": {"j11": 0}}, "locked_joints: no such joint; got 'j11'; accepted: j1"),
    "unknown limit": ({"joint_limits": {"k1": {"lower": 0}}}, "joint_limits: no such joint; got 'k1'"),
    "home outside": ({"home": [0, 2.5]}, "home.j2: home is outside the joint limits; got 2.5; accepted: -2..2"),
    "homes outside": (
        {"home": [-3, 2.5]},
        "home: home is outside the joint limits; got 'j1 -3, j2 2.5'; accepted: j1 -2..2, j2 -2..2",
    ),
    "tool": ({"tool": "for"}, "tool: no such link; got 'for'; accepted: fore"),
    "all locked": ({"locked_joints": {"j1": 0, "j2": 0}}, "no moving joint is left"),
    "inertia list": ({"base": BASE | {"inertia": [1, 2]}}, "base.inertia: wrong number of values"),
    "unknown key": ({"base_mod": "x"}, "robot base_mod: unknown key; accepted: did you mean base_mode"),
}


@pytest.mark.parametrize("case", BAD_FILES)
def test_bad_robot_files_are_refused_by_key(case: str) -> None:
    """What does not fit the robot is one SpecError line with key, value and what is accepted."""
    changes, message = BAD_FILES[case]
    with pytest.raises(SpecError) as error:
        load_robot(robot_file(**changes))
    assert message in str(error.value)
    assert "\n" not in str(error.value)


def test_non_finite_lock_is_refused() -> None:
    """An infinity given as Python data, past the YAML reader, is refused too."""
    with pytest.raises((SpecError, NonFiniteError), match=r"locked_joints\.j1"):
        load_robot(robot_file(locked_joints={"j1": float("inf")}))


def test_unknown_robots_and_missing_files() -> None:
    """An unknown name shows the nearest ones, a missing file is an InputFileError that shows the path."""
    with pytest.raises(SpecError, match=r"'minni'; accepted: a robot file, or one of: mini"):
        load_robot("minni")
    with pytest.raises(SpecError, match=r"a URDF alone cannot be run.*urdf: mini\.urdf"):
        load_robot("config/robots/mini.urdf")
    with pytest.raises(InputFileError, match=r"nowhere/robot\.yaml"):
        load_robot("nowhere/robot.yaml")
    with pytest.raises(InputFileError, match=r"urdf: no such URDF file.*arm\.urdf"):
        load_robot(robot_file("arm.urdf"))
    with pytest.raises(InputFileError, match=r"has no such file.*nothing"):
        load_robot(robot_file("example-robot-data:nothing.urdf"))
