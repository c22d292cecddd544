"""A controller that knows nothing of this project: rclpy, four standard topics in, two out.

ros2 run space_robot_sim recorder --experiment liu2023/fig08 --out runs/mine
ros2 run space_robot_sim simulator --experiment liu2023/fig08
ros2 run space_robot_control guidance --experiment liu2023/fig08
python examples/rclpy_controller.py
"""

import numpy as np
import rclpy
from geometry_msgs.msg import WrenchStamped
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory

TOPICS = {"base/odom": Odometry, "joint_states": JointState}
TOPICS |= {"reference/base": Odometry, "reference/joints": JointTrajectory}
QOS = QoSProfile(depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class PdController(Node):
    """PD in torques. References come ahead, many at once, and before a late node: hence the quality of service."""

    def __init__(self, **options) -> None:
        super().__init__("pd_controller", **options)
        self.parts: dict[tuple[int, int], dict] = {}
        self.wrench = self.create_publisher(WrenchStamped, "base/wrench_command", QOS)
        self.effort = self.create_publisher(JointState, "joint_command", QOS)
        for name, kind in TOPICS.items():
            self.create_subscription(kind, name, lambda message, name=name: self.take(name, message), QOS)

    def take(self, name: str, message) -> None:
        """Answer once all four messages of a stamp are there."""
        stamp = message.header.stamp
        parts = self.parts.setdefault((stamp.sec, stamp.nanosec), {})
        parts[name] = message
        if len(parts) == len(TOPICS):
            self.answer(stamp, *(parts[topic] for topic in TOPICS))

    def answer(self, stamp, odom, joints, base, arm) -> None:
        """Publish torque on the base and joint efforts."""
        w = odom.twist.twist.angular
        a, d = (np.array([q.x, q.y, q.z, q.w]) for q in (odom.pose.pose.orientation, base.pose.pose.orientation))
        turn = 2.0 * (a[3] * d[:3] - d[3] * a[:3] - np.cross(a[:3], d[:3])) * np.sign(a @ d)
        wrench, command = WrenchStamped(), JointState(name=joints.name)
        wrench.header.stamp, wrench.header.frame_id, command.header.stamp = stamp, "base_link", stamp
        torque = 2.0 * (0.2 * turn - np.array([w.x, w.y, w.z]))
        wrench.wrench.torque.x, wrench.wrench.torque.y, wrench.wrench.torque.z = torque.tolist()
        e = np.subtract(arm.points[0].positions, joints.position)
        command.effort = ([0.2, 0.2, 0.1, 0.02] * (0.2 * e - np.array(joints.velocity))).tolist()
        self.wrench.publish(wrench)
        self.effort.publish(command)


if __name__ == "__main__":
    rclpy.init()
    rclpy.spin(PdController())
