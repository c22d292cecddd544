"""Standard messages from outside to set-points; what they say is checked where it is used."""

from __future__ import annotations

from typing import Any

from space_robot_control.references.trajectory import Trajectory, TrajectoryPoint
from space_robot_msgs_py.codec.message_layouts import INERTIAL
from space_robot_msgs_py.errors import LayoutError
from space_robot_msgs_py.interfaces import NANOSECONDS

Numbers = tuple[float, ...]


def trajectory_in(message: Any) -> Trajectory:
    """What a trajectory_msgs/JointTrajectory says; its frame means nothing, and efforts are not looked at."""
    points = [
        TrajectoryPoint(
            nanoseconds_in(point.time_from_start),
            tuple(point.positions),
            tuple(point.velocities),
            tuple(point.accelerations),
        )
        for point in message.points
    ]
    return Trajectory(tuple(message.joint_names), points, nanoseconds_in(message.header.stamp))


def pose_in(message: Any, key: str) -> tuple[Numbers, Numbers]:
    """Position [m] and quaternion (x, y, z, w) of a geometry_msgs/PoseStamped.

    Raises:
        LayoutError: it is in another frame than `inertial`.
    """
    frame = message.header.frame_id
    if frame not in ("", INERTIAL):
        raise LayoutError("wrong frame", key=f"{key}.header.frame_id", value=frame, accepted=INERTIAL)
    p, q = message.pose.position, message.pose.orientation
    return (p.x, p.y, p.z), (q.x, q.y, q.z, q.w)


def twist_in(message: Any) -> Numbers:
    """Linear, then angular velocity of a geometry_msgs/Twist [m/s, rad/s]."""
    linear, angular = message.linear, message.angular
    return linear.x, linear.y, linear.z, angular.x, angular.y, angular.z


def nanoseconds_in(time: Any) -> int:
    """A builtin_interfaces/Time or Duration [ns]."""
    return int(time.sec) * NANOSECONDS + int(time.nanosec)
