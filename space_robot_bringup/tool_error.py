"""How far the tool was from where it should have been: what a task of the end effector is judged by."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from space_robot_control.references.tool_kinematics import tool_pose
from space_robot_control.rotations import log, relative
from space_robot_description.robot import Robot
from space_robot_msgs_py.interfaces import Vector

Matrix = npt.NDArray[np.float64]


def tool_errors(robot: Robot, actual: Matrix, desired: Matrix) -> tuple[Vector, Vector]:
    """Return the distance of the tool from its desired place (K,) [m] and the angle to its desired attitude (K,) [rad].

    Args:
        robot: for the tool frame.
        actual: (K, 7+n) configurations that were [m, -, rad].
        desired: (K, 7+n) configurations that were asked for.
    """
    pairs = [(tool_pose(robot, q), tool_pose(robot, q_d)) for q, q_d in zip(actual, desired, strict=True)]
    position = np.array([np.linalg.norm(pose.position - aim.position) for pose, aim in pairs])
    angle = np.array([np.linalg.norm(log(relative(pose.quaternion, aim.quaternion))) for pose, aim in pairs])
    return position, angle
