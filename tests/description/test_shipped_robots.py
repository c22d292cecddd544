"""The shipped robots hold exactly the numbers of docs/robots.md."""

from __future__ import annotations

from xml.etree import ElementTree as ET

import numpy as np
import pinocchio as pin
import pytest

from space_robot_description.load import load_robot
from space_robot_description.robot import Robot
from space_robot_description.share import shipped
from space_robot_description.spec import ReactionWheels, Thrusters
from space_robot_msgs_py.interfaces import Vector

# mass; com; Ixx, Iyy, Izz, Ixy, Ixz, Iyz about the com
MINI = {
    "base_link": (30.0, (0.010, -0.008, 0.015), (1.05, 1.15, 0.95, 0.020, -0.015, 0.010)),
    "yaw": (1.2, (0, 0.005, -0.020), (0.0022, 0.0020, 0.0018, 0, 0, 0.0001)),
    "upper_arm": (1.8, (0.150, 0, 0.020), (0.0025, 0.0180, 0.0180, 0, 0.0006, 0)),
    "fore_arm": (1.4, (0.010, -0.120, 0), (0.0110, 0.0016, 0.0110, 0.0004, 0, 0)),
    "antenna": (2.0, (0.020, 0.010, 0.100), (0.0300, 0.0290, 0.0450, 0.0010, 0.0020, -0.0015)),
}
# Craig: alpha_{i-1} [deg], a_{i-1} [m], d_i [m]; the first row stands on the mount.
MINI_DH = ((0, 0, 0), (90, 0, 0), (0, 0.35, 0), (90, 0, 0.30))
MINI_MOUNT = (0.10, 0, 0.25)
# name: base mass, base inertia, root, radius, links (axis, length, mass), home, force, torque, efforts
CYLINDERS = {
    "servicer": (
        950, (520, 480, 560), (0, 0, 0.95), 0.08,
        "z .20 10; y .20 10; x 1.1 14; y .20 8; x 1.0 12; y .20 7; z .20 6; x .30 6",
        (0.3, -0.9, 0.2, 1.4, 0.1, 0.7, 0.3, 0), 60, 20, (200, 200, 200, 150, 100, 80, 80, 80),
    ),
    "ets7": (
        2550, (6200, 3540, 7090), (1.0, 0, 0.8), 0.10,
        "z .25 30; y .25 25; x 1.2 26; y .25 18; x 1.1 20; y .25 12; x .35 10",
        (0.3, -0.9, 0.2, 1.4, 0.1, 0.8, 0), 150, 100, (300, 300, 300, 250, 150, 120, 120),
    ),
}  # fmt: skip


def _configuration(robot: Robot, joints: Vector) -> Vector:
    return np.concatenate([pin.neutral(robot.model)[:7], joints])


def _craig(alpha: float, a: float, d: float, theta: float) -> Vector:
    ca, sa, ct, st = np.cos(alpha), np.sin(alpha), np.cos(theta), np.sin(theta)
    return np.array([[ct, -st, 0, a], [st * ca, ct * ca, -sa, -sa * d], [st * sa, ct * sa, ca, ca * d], [0, 0, 0, 1]])


def test_mini_bodies_are_those_of_the_table() -> None:
    """Mass, centre of mass and inertia of every body of mini are the tabulated ones."""
    robot = load_robot("mini")
    assert robot.body_names == tuple(MINI)
    for index, (mass, com, (ixx, iyy, izz, ixy, ixz, iyz)) in enumerate(MINI.values(), start=1):
        body = robot.model.inertias[index]
        assert body.mass == mass
        np.testing.assert_allclose(body.lever, com, rtol=0, atol=1e-17)
        np.testing.assert_allclose(
            body.inertia, [[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]], rtol=0, atol=1e-15
        )


@pytest.mark.parametrize("seed", range(5))
def test_mini_kinematics_are_the_dh_table(seed: int) -> None:
    """Every joint frame of mini stands where Craig's DH product puts it, whatever the joint angles."""
    robot = load_robot("mini")
    theta = np.random.default_rng(seed).uniform(-3, 3, size=4)
    data = robot.model.createData()
    pin.forwardKinematics(robot.model, data, _configuration(robot, theta))
    expected = np.eye(4)
    expected[:3, 3] = MINI_MOUNT
    for index, (alpha, a, d) in enumerate(MINI_DH):
        expected = expected @ _craig(np.radians(alpha), a, d, theta[index])
        np.testing.assert_allclose(data.oMi[index + 2].homogeneous, expected, atol=1e-14)


def test_mini_limits_and_actuation_are_those_of_the_paper_page() -> None:
    """Mini floats freely on three orthogonal wheels, joint 2 turns 0..180 deg and the others +-180 deg."""
    robot = load_robot("mini")
    assert robot.base_mode == "free_floating"
    np.testing.assert_array_equal(robot.joint_lower, [-np.pi, 0.0, -np.pi, -np.pi])
    np.testing.assert_array_equal(robot.joint_upper, [np.pi] * 4)
    assert isinstance(robot.actuators.base_torque, ReactionWheels)
    np.testing.assert_array_equal(robot.actuators.base_torque.axes, np.eye(3))


@pytest.mark.parametrize("name", CYLINDERS)
def test_cylinder_robots_are_those_of_the_table(name: str) -> None:
    """Every link of servicer and ets7 is the tabulated solid cylinder, its joint where the previous cylinder ends."""
    mass, base_inertia, root, radius, links, *_ = CYLINDERS[name]
    robot = load_robot(name)
    model = robot.model
    assert model.inertias[1].mass == mass
    np.testing.assert_allclose(model.inertias[1].inertia, np.diag(base_inertia), atol=1e-12)
    origin = np.array(root)
    rows = [row.split() for row in links.split(";")]
    assert robot.n == len(rows)
    for index, (axis, length_text, mass_text) in enumerate(rows, start=2):
        length, link_mass, body = float(length_text), float(mass_text), model.inertias[index]
        assert model.joints[index].shortname() == f"JointModelR{axis.upper()}"
        np.testing.assert_allclose(model.jointPlacements[index].homogeneous[:3, 3], origin, atol=1e-15)
        np.testing.assert_array_equal(model.jointPlacements[index].rotation, np.eye(3))
        across = link_mass * (3 * radius**2 + length**2) / 12
        assert body.mass == link_mass
        np.testing.assert_allclose(body.lever, [length / 2, 0, 0], atol=1e-15)
        expected = np.diag([link_mass * radius**2 / 2, across, across])
        np.testing.assert_allclose(body.inertia, expected, rtol=1e-11, atol=1e-15)
        origin = np.array([length, 0, 0])
    tool = model.frames[model.getFrameId("tool", pin.FrameType.BODY)]
    np.testing.assert_allclose(tool.placement.translation, origin, atol=1e-15)


@pytest.mark.parametrize("name", CYLINDERS)
def test_cylinder_robots_have_the_tabulated_thrusters(name: str) -> None:
    """Servicer and ets7 are free-flying, with the tabulated force, torque and joint limits and posture."""
    *_, home, force, torque, efforts = CYLINDERS[name]
    robot = load_robot(name)
    assert robot.base_mode == "free_flying"
    assert isinstance(robot.actuators.base_torque, Thrusters)
    assert isinstance(robot.actuators.base_force, Thrusters)
    assert robot.actuators.base_force.limit == (force,) * 3
    assert robot.actuators.base_torque.limit == (torque,) * 3
    np.testing.assert_array_equal(robot.effort_limit, efforts)
    np.testing.assert_array_equal(robot.home, home)


@pytest.mark.parametrize("name", shipped("robots"))
def test_shipped_robots_fit_the_contract(name: str) -> None:
    """A shipped robot is a free-flyer with a coordinate per joint that follows none, no gravity, and can be drawn."""
    robot = load_robot(name)
    model = robot.model
    assert (model.nq, model.nv, model.njoints) == (7 + robot.n, 6 + robot.n, 2 + robot.n + len(robot.mimics))
    assert model.joints[1].shortname() == "JointModelFreeFlyer"
    moved = dict(zip(tuple(model.names)[2:], list(model.joints)[2:], strict=True))
    sizes = {name: (0, 0) if name in robot.mimics else (1, 1) for name in moved}
    assert {name: (joint.nq, joint.nv) for name, joint in moved.items()} == sizes
    assert tuple(name for name in moved if name not in robot.mimics) == robot.joint_names
    assert not np.any(model.gravity.vector)
    assert model.existFrame(robot.tool_frame)
    assert ET.fromstring(robot.urdf).find("link[@name='base_link']/visual") is not None
    for values in (robot.effort_limit, robot.joint_lower, robot.joint_upper, robot.joint_rate_limit, robot.home):
        assert values.shape == (robot.n,)
        assert not values.flags.writeable
