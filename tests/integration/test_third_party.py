"""A controller that knows nothing of this project: rclpy and standard messages are enough to run the robot."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("rclpy")
from geometry_msgs.msg import Vector3Stamped, WrenchStamped
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory

from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.logs.assessed import read_judged
from space_robot_bringup.logs.info import bag_info
from space_robot_bringup.modes.run import Mode, judge_log, run_experiment
from space_robot_msgs_py.codec.generic import parse
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.topics import ATTITUDE
from space_robot_report.pages.log_report import log_page
from tests.support.harness import running_graph
from tests.support.replays import replayed

pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]

QOS = QoSProfile(depth=1000, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class Stranger(Node):  # type: ignore[misc]
    """PD on base attitude and joints, in torques, from four standard topics to two."""

    stiffness, damping = 0.2, 1.0
    inertia = np.array([2.0, 2.0, 1.2])
    joint_inertia = np.array([0.2, 0.2, 0.1, 0.02])

    def __init__(self, **options: Any) -> None:
        super().__init__("third_party_controller", **options)
        self.parts: dict[int, dict[str, Any]] = {}
        self.angles: dict[int, tuple[float, float, float]] = {}
        self.wrench = self.create_publisher(WrenchStamped, "base/wrench_command", QOS)
        self.effort = self.create_publisher(JointState, "joint_command", QOS)
        for name, kind in {
            "base/odom": Odometry,
            "joint_states": JointState,
            "reference/base": Odometry,
            "reference/joints": JointTrajectory,
        }.items():
            self.create_subscription(kind, name, lambda message, name=name: self.take(name, message), QOS)

        self.create_subscription(Vector3Stamped, "base/attitude_rpy_deg", self.plot, 10)

    def plot(self, message: Any) -> None:
        """Keep the attitude in degrees, as a tool does that plots it."""
        stamp = message.header.stamp.sec * 10**9 + message.header.stamp.nanosec
        self.angles[stamp] = (message.vector.x, message.vector.y, message.vector.z)

    def take(self, name: str, message: Any) -> None:
        """Answer a stamp once all four of its messages are there."""
        stamp = message.header.stamp.sec * 10**9 + message.header.stamp.nanosec
        parts = self.parts.setdefault(stamp, {})
        parts[name] = message
        if len(parts) == 4:
            del self.parts[stamp]
            self.answer(*(parts[key] for key in ("base/odom", "joint_states", "reference/base", "reference/joints")))

    def answer(self, odom: Any, joints: Any, base: Any, arm: Any) -> None:
        """Publish both parts of the command with the stamp of the state."""
        turn = 2.0 * vector_part(odom.pose.pose.orientation, base.pose.pose.orientation)
        rate = odom.twist.twist.angular
        torque = self.inertia * (self.stiffness * turn - self.damping * np.array([rate.x, rate.y, rate.z]))
        wanted = np.array(arm.points[0].positions) - np.array(joints.position)
        effort = self.joint_inertia * (self.stiffness * wanted - self.damping * np.array(joints.velocity))
        wrench = WrenchStamped()
        wrench.header.stamp, wrench.header.frame_id = odom.header.stamp, "base_link"
        wrench.wrench.torque.x, wrench.wrench.torque.y, wrench.wrench.torque.z = torque.tolist()
        self.wrench.publish(wrench)
        command = JointState(name=joints.name, effort=effort.tolist())
        command.header.stamp = odom.header.stamp
        self.effort.publish(command)


def angles_in(run: Path) -> dict[int, tuple[float, float, float]]:
    """Stamp [ns] to roll, pitch and yaw [deg] of a log."""
    found = {}
    for name, stamp, raw in LogReader(run).messages():
        if name == ATTITUDE.name:
            vector = parse(ATTITUDE.type, raw).vector
            found[stamp] = (vector.x, vector.y, vector.z)
    return found


def vector_part(actual: Any, desired: Any) -> Any:
    """Vector part of the rotation from the actual to the desired attitude, the short way."""
    a, d = (np.array([q.x, q.y, q.z, q.w]) for q in (actual, desired))
    vector = a[3] * d[:3] - d[3] * a[:3] - np.cross(a[:3], d[:3])
    return vector * np.sign(a @ d)


def test_a_third_party_node_controls_the_robot(tmp_path: Path) -> None:
    """With a third-party controller only, the run completes, the robot reaches its target and no command is refused."""
    with running_graph(
        tmp_path / "run",
        "expect={}",
        "duration=200.0",
        "controller.law=external",
        roles=("recorder", "guidance", "simulator"),
    ) as robot:
        stranger = Stranger(context=robot.context)
        robot.executor.add_node(stranger)
        robot.spin_until(lambda: robot.recorder.complete and robot.simulator.end_reason, "the end of the run")
        assert robot.simulator.end_reason == "completed"
        assert not robot.simulator.commands.counts
        robot.recorder.finish("completed")
        result = judge_log(tmp_path / "run", robot.composition, "completed", 0.0)
        stranger.destroy_node()
    assert result.metrics is not None
    assert [check for check in result.checks if not check.passed] == []
    for axis in result.metrics.axes:
        assert axis.final_error < 0.5, f"{axis.name} is off by {axis.final_error} deg"
    topics = {name for name, _, _ in LogReader(tmp_path / "run").messages()}
    assert "controller/telemetry" not in topics
    # What it plotted live is what the log has.
    assert stranger.angles.items() <= angles_in(tmp_path / "run").items()
    assert len(stranger.angles) > 100
    assert bag_info(tmp_path / "run").provenance["commanded by"] == "/third_party_controller"
    assert "under external (/third_party_controller)" in log_page(read_judged(tmp_path / "run"))
    # There is no law to be compared with; the plant is.
    assert [outcome.against for outcome in replayed(tmp_path / "run").outcomes] == ["plant"]
    with pytest.raises(ValueError, match="--against: the run had none of its own"):
        replayed(tmp_path / "run", against="controller")


@pytest.mark.parametrize("mode", ["headless", "graph"])
def test_an_external_controller_is_not_made_here(tmp_path: Path, mode: Mode) -> None:
    """Where no node of another project can come, and with gains or other laws, one line says so and nothing is run."""
    experiment = load_experiment("liu2023/fig08", ["controller.law=external"])
    with pytest.raises(SpecError, match=r"controller\.law: has no controller here"):
        run_experiment(experiment, tmp_path / "run", mode=mode)
    assert not (tmp_path / "run").exists()
    with pytest.raises(SpecError, match=r"controller\.gains: an external controller has none"):
        load_experiment("liu2023/fig08", ["controller.law=external", "controller.gains.kappa=1.0"])
