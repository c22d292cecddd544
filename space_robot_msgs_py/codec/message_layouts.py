"""The layouts of the standard messages the project sends, field by field in the order of their definitions."""

from __future__ import annotations

from collections.abc import Sequence

from space_robot_msgs_py.codec.layout import ErrorClass, Layout, LayoutBuilder
from space_robot_msgs_py.errors import LayoutError

INERTIAL = "inertial"
BASE_LINK = "base_link"
BASE_LINK_DESIRED = "base_link_desired"


def odometry(topic: str, child_frame: str) -> Layout:
    """nav_msgs/Odometry in `inertial`; holes: stamp, pose (7), twist (6)."""
    builder = LayoutBuilder(topic).stamp().string(INERTIAL, "header.frame_id").string(child_frame, "child_frame_id")
    builder.doubles(7, "pose.pose").ignored(36, "pose.covariance")
    return builder.doubles(6, "twist.twist").ignored(36, "twist.covariance").build()


def joint_state(topic: str, joints: Sequence[str], fields: Sequence[str], error: ErrorClass = LayoutError) -> Layout:
    """sensor_msgs/JointState; holes: stamp, then those of position, velocity, effort that are in ``fields`` (n)."""
    builder = LayoutBuilder(topic, error).stamp().string("", "header.frame_id").strings(joints, "name")
    for field in ("position", "velocity", "effort"):
        builder = builder.sequence(len(joints), field) if field in fields else builder.uint32(0, field)
    return builder.build()


def imu(topic: str) -> Layout:
    """sensor_msgs/Imu in `base_link`; holes: stamp, orientation (4), angular velocity (3), linear acceleration (3)."""
    builder = LayoutBuilder(topic).stamp().string(BASE_LINK, "header.frame_id")
    for field, size in (("orientation", 4), ("angular_velocity", 3), ("linear_acceleration", 3)):
        builder.doubles(size, field).ignored(9, f"{field}_covariance")
    return builder.build()


def vector_stamped(topic: str) -> Layout:
    """geometry_msgs/Vector3Stamped in `base_link`; holes: stamp, vector (3)."""
    return LayoutBuilder(topic).stamp().string(BASE_LINK, "header.frame_id").doubles(3, "vector").build()


def accel_stamped(topic: str) -> Layout:
    """geometry_msgs/AccelStamped in `base_link_desired`; holes: stamp, acceleration (6)."""
    return LayoutBuilder(topic).stamp().string(BASE_LINK_DESIRED, "header.frame_id").doubles(6, "accel").build()


def wrench_stamped(topic: str, error: ErrorClass = LayoutError) -> Layout:
    """geometry_msgs/WrenchStamped in `base_link`; holes: stamp, wrench (6)."""
    return LayoutBuilder(topic, error).stamp().string(BASE_LINK, "header.frame_id").doubles(6, "wrench").build()


def vector3_stamped(topic: str) -> Layout:
    """geometry_msgs/Vector3Stamped in `inertial`; holes: stamp, vector (3)."""
    return LayoutBuilder(topic).stamp().string(INERTIAL, "header.frame_id").doubles(3, "vector").build()


def joint_trajectory(topic: str, joints: Sequence[str]) -> Layout:
    """trajectory_msgs/JointTrajectory of one point; holes: stamp, positions, velocities, accelerations (n each)."""
    builder = LayoutBuilder(topic).stamp().string("", "header.frame_id").strings(joints, "joint_names")
    builder.uint32(1, "points")
    for field in ("positions", "velocities", "accelerations"):
        builder.sequence(len(joints), f"points[0].{field}")
    builder.uint32(0, "points[0].effort")
    return builder.uint32(0, "points[0].time_from_start.sec").uint32(0, "points[0].time_from_start.nanosec").build()


def tf_message(topic: str, pairs: Sequence[tuple[str, str]]) -> Layout:
    """tf2_msgs/TFMessage of (parent, child) frames; holes: stamp, then translation and rotation (7), of each."""
    builder = LayoutBuilder(topic).uint32(len(pairs), "transforms")
    for index, (parent, child) in enumerate(pairs):
        name = f"transforms[{index}]"
        builder.stamp(f"{name}.header.stamp").string(parent, f"{name}.header.frame_id")
        builder.string(child, f"{name}.child_frame_id").doubles(7, f"{name}.transform")
    return builder.build()


def multi_array(topic: str, labels: Sequence[str], sizes: Sequence[int]) -> Layout:
    """std_msgs/Float64MultiArray with one dimension entry for each block; holes: first block, all other blocks."""
    builder = LayoutBuilder(topic).uint32(len(labels), "layout.dim")
    for index, (label, size) in enumerate(zip(labels, sizes, strict=True)):
        name = f"layout.dim[{index}]"
        builder.string(label, f"{name}.label").uint32(size, f"{name}.size").uint32(size, f"{name}.stride")
    builder.uint32(0, "layout.data_offset").uint32(sum(sizes), "data")
    return builder.doubles(sizes[0], "data").doubles(sum(sizes[1:]), "data").build()
