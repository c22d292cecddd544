"""Targets as people write them to configurations, checked against the robot."""

from __future__ import annotations

from math import degrees, radians

import numpy as np

from space_robot_control.references.spec import Target
from space_robot_description.robot import Robot
from space_robot_description.rotations import from_rpy, normalized
from space_robot_description.spec import expand
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.vectors import Vector, vector

LIMIT_TOLERANCE = 1e-5  # [rad]; limits in robot files are often rounded: 3.14159 for 180 degrees


def initial_configuration(initial_q: Vector, robot: Robot) -> Vector:
    """Return a checked (7+n,) copy of the configuration a motion starts from, quaternion normalised.

    Raises:
        CommandError: the size does not fit the robot.
        NonFiniteError: a number is not finite.
        SpecError: the quaternion is zero.
    """
    q = np.array(vector(initial_q, 7 + robot.n, "initial_q"))
    q[3:7] = normalized(q[3:7], "initial_q (quaternion)")
    return q


def configuration(target: Target, robot: Robot, previous: Vector, key: str) -> Vector:
    """Return the configuration of a target.

    Args:
        target: of the experiment file.
        robot: for joint names and limits.
        previous: (7+n,) configuration for what the target leaves out.
        key: what to call the target in an error.

    Returns:
        (7+n,) a new array [m, -, rad], unit quaternion.

    Raises:
        SpecError: wrong sizes, unknown joints, a joint outside its limits, a zero quaternion.
    """
    q = np.array(previous)
    if target.position is not None:
        q[:3] = target.position
    if target.attitude_deg is not None:
        q[3:7] = from_rpy([radians(angle) for angle in target.attitude_deg])
    if target.quaternion is not None:
        q[3:7] = normalized(target.quaternion, f"{key}.quaternion")
    if target.joints is not None:
        q[7:] = expand(target.joints, robot.joint_names, f"{key}.joints", q[7:].tolist())
        check_limits(q[7:], q[7:], robot, f"{key}.joints")
    if target.joints_deg is not None:
        rest = np.degrees(q[7:]).tolist()
        q[7:] = np.radians(expand(target.joints_deg, robot.joint_names, f"{key}.joints_deg", rest))
        check_limits(q[7:], q[7:], robot, f"{key}.joints_deg", in_degrees=True)
    if target.joints_by_deg is not None:
        still = [0.0] * robot.n
        q[7:] += np.radians(expand(target.joints_by_deg, robot.joint_names, f"{key}.joints_by_deg", still))
        check_limits(q[7:], q[7:], robot, f"{key}.joints_by_deg", in_degrees=True)
    return q


def check_limits(lowest: Vector, highest: Vector, robot: Robot, key: str, in_degrees: bool = False) -> None:
    """Refuse a motion that leaves the joint limits.

    Args:
        lowest: (n,) smallest position of each joint [rad or m].
        highest: (n,) largest position [rad or m].
        robot: for names and limits.
        key: what to call the positions in an error.
        in_degrees: give the numbers in degrees.

    Raises:
        SpecError: names the first joint outside, its value and its limits.
    """
    unit, shown = ("deg", degrees) if in_degrees else ("rad or m", float)
    for i, name in enumerate(robot.joint_names):
        lower, upper = float(robot.joint_lower[i]), float(robot.joint_upper[i])
        for value in (float(lowest[i]), float(highest[i])):
            if not lower - LIMIT_TOLERANCE <= value <= upper + LIMIT_TOLERANCE:
                accepted = f"{shown(lower):.6g} to {shown(upper):.6g} [{unit}]"
                raise SpecError(
                    "outside the joint's limits", key=f"{key}.{name}", value=round(shown(value), 9), accepted=accepted
                )
