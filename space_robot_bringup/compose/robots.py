"""The robots of a run: as the flight software believes in them, as they are, and where they start."""

from __future__ import annotations

from math import radians

import numpy as np

from space_robot_bringup.experiment.experiment import Initial
from space_robot_bringup.experiment.plant import ModelSpec
from space_robot_control.references.targets import check_limits
from space_robot_description.dispersion import disperse
from space_robot_description.payload import attach_payload
from space_robot_description.robot import Robot
from space_robot_description.rotations import from_rpy
from space_robot_description.spec import expand
from space_robot_msgs_py.interfaces import Vector


def unladen(spec: ModelSpec) -> ModelSpec:
    """The same without a payload."""
    return spec.model_copy(update={"payload": None})


def variant_of(robot: Robot, spec: ModelSpec, seed: np.random.SeedSequence) -> Robot:
    """A robot with the dispersion and the payload of a model of it, drawn from a seed."""
    if spec.dispersion is not None:
        robot = disperse(robot, spec.dispersion, np.random.default_rng(seed))
    if spec.payload is not None:
        robot = attach_payload(robot, spec.payload)
    return robot


def initial_state(spec: Initial, robot: Robot) -> tuple[Vector, Vector]:
    """(7+n,) configuration and (6+n,) velocity, as in RobotState, at which a run starts.

    Raises:
        SpecError: joints that the robot does not have, or that are beyond their limits.
    """
    joints = robot.home
    if spec.joints_deg is not None:
        joints = np.radians(
            expand(spec.joints_deg, robot.joint_names, "initial.joints_deg", np.degrees(joints).tolist())
        )
        check_limits(joints, joints, robot, "initial.joints_deg", in_degrees=True)
    elif spec.joints is not None:
        joints = expand(spec.joints, robot.joint_names, "initial.joints", joints.tolist())
        check_limits(joints, joints, robot, "initial.joints")
    quaternion = from_rpy([radians(angle) for angle in spec.attitude_deg])
    q0 = np.concatenate([np.array(spec.position), quaternion, joints])
    v0 = np.concatenate([np.array(spec.linear_velocity), np.array(spec.angular_velocity), np.zeros(robot.n)])
    return q0, v0
