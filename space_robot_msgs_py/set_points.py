"""Topics on which other programs say where the robot is to go; nothing of this project publishes them."""

from __future__ import annotations

from space_robot_msgs_py.topics import Topic

JOINT_TRAJECTORY = Topic(
    "joint_trajectory",
    "trajectory_msgs/msg/JointTrajectory",
    "set_point",
    "any node",
    "points in time for the joints, by name; at once where the stamp is 0",
    recorded=False,
)
BASE_GOAL = Topic(
    "base/goal",
    "geometry_msgs/msg/PoseStamped",
    "set_point",
    "any node",
    "where the base is to rest, in `inertial`; of a free-floating one the position is not looked at",
    recorded=False,
)
TOOL_GOAL = Topic(
    "tool/goal",
    "geometry_msgs/msg/PoseStamped",
    "set_point",
    "any node",
    "where the tool is to rest, in `inertial`; of an arm of fewer than six joints only the position",
    recorded=False,
)
TELEOP = Topic(
    "teleop",
    "geometry_msgs/msg/Twist",
    "set_point",
    "any node",
    "how the tool is to move, in its own axes; without a message it stops",
    recorded=False,
)

SET_POINTS: tuple[Topic, ...] = (JOINT_TRAJECTORY, BASE_GOAL, TOOL_GOAL, TELEOP)
