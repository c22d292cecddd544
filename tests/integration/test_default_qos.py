"""A node with the default quality of service of ROS, RELIABLE and VOLATILE, commands the robot whenever it comes."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from threading import Event, Thread
from typing import Any

import pytest

pytest.importorskip("rclpy")
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import WrenchStamped
from nav_msgs.msg import Odometry
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy, qos_profile_sensor_data
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.context import local_context, reserved_domain
from space_robot_bringup.modes.hooks import Hooks
from space_robot_bringup.modes.processes import run_processes
from space_robot_msgs_py.topics import BASE_ODOM, JOINT_COMMAND, REFERENCE_BASE, REFERENCE_JOINTS
from tests.support.commanded import ALONE, efforts, end
from tests.support.diagnostics import heard
from tests.support.follow import DEADLINE
from tests.support.harness import running_graph

pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]
EFFORT = 0.002


class Plain(Node):  # type: ignore[misc]
    """As it is written everywhere: ``create_publisher(T, topic, 10)``; it answers every state with a small torque."""

    def __init__(self, joint_names: tuple[str, ...], **options: Any) -> None:
        super().__init__("plain", **options)
        self.names, self.answered = list(joint_names), list[int]()
        self.wrench = self.create_publisher(WrenchStamped, "base/wrench_command", 10)
        self.joints = self.create_publisher(JointState, "joint_command", 10)
        self.create_subscription(Odometry, "base/odom", self.answer, 10)

    def answer(self, odom: Any) -> None:
        """Both parts of the command, with the stamp of the state."""
        self.answered.append(odom.header.stamp.sec * 10**9 + odom.header.stamp.nanosec)
        wrench = WrenchStamped()
        wrench.header.stamp, wrench.header.frame_id = odom.header.stamp, "base_link"
        self.wrench.publish(wrench)
        command = JointState(name=self.names, effort=[EFFORT] * len(self.names))
        command.header.stamp = odom.header.stamp
        self.joints.publish(command)


class Joining(Plain):
    """It waits for the reference of a state, too, which was published before it came; again with the default queue."""

    def __init__(self, joint_names: tuple[str, ...], **options: Any) -> None:
        self.parts: dict[int, set[str]] = {}
        super().__init__(joint_names, **options)
        self.create_subscription(Odometry, REFERENCE_BASE.name, lambda m: self.join(REFERENCE_BASE.name, m), 10)
        self.create_subscription(
            JointTrajectory, REFERENCE_JOINTS.name, lambda m: self.join(REFERENCE_JOINTS.name, m), 10
        )

    def answer(self, odom: Any) -> None:
        """A state is one of three parts."""
        self.join(BASE_ODOM.name, odom)

    def join(self, name: str, message: Any) -> None:
        """Answer once all three have come."""
        parts = self.parts.setdefault(message.header.stamp.sec * 10**9 + message.header.stamp.nanosec, set())
        parts.add(name)
        if len(parts) == 3:
            super().answer(message)


def commands_alone(
    place: Path, *, later: float, kind: type[Plain] = Plain, prepare: Callable[[Plain], None] = lambda plain: None
) -> None:
    """A plain node that comes so many seconds later answers every state of a run: each answer acts and is recorded."""
    with running_graph(place, "duration=5.0", roles=ALONE) as robot:
        robot.spin_for(later)
        plain = kind(robot.composition.joint_names, context=robot.context)
        prepare(plain)
        robot.executor.add_node(plain)
        end(robot)
        assert robot.simulator.end_reason == "completed"
        assert robot.simulator.commands.counts.keys() <= {"repeated"}
        plain.destroy_node()
    assert efforts(place) == [EFFORT] * 21


def test_it_commands_in_lock_step(tmp_path: Path) -> None:
    """It may come late: the state that waits is said again, and every one is answered, acts and is recorded."""
    commands_alone(tmp_path / "run", later=0.3)


@pytest.mark.parametrize("kind", [Plain, Joining])
def test_one_that_takes_the_place_of_another_gets_what_waits(kind: type[Plain], tmp_path: Path) -> None:
    """A controller leaves in mid-run without an answer; a plain node that comes then goes on with the same state."""
    with running_graph(tmp_path / "run", "duration=10.0") as robot:
        robot.simulator.pause(True)
        left = robot.await_answer()
        robot.executor.remove_node(robot.nodes["controller"])
        robot.nodes.pop("controller").destroy_node()
        robot.simulator.pause(False)
        robot.spin_for(0.3)
        plain = kind(robot.composition.joint_names, context=robot.context)
        robot.executor.add_node(plain)
        end(robot)
        plain.destroy_node()
    found = efforts(tmp_path / "run")
    assert len(found) == 41
    assert EFFORT not in found[: left + 1]
    assert found[left + 1 :] == [EFFORT] * (40 - left)


@pytest.mark.parametrize("realtime", [None, 20.0])
def test_it_commands_from_another_process(
    realtime: float | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Beside the processes of a run in which our controller never comes, in lock-step and paced."""
    # Paced it waits for no node: 1 s of the clock was over before a busy machine had matched the nodes.
    duration = 20.0 if realtime is None else 100.0
    composition = compose(load_experiment("liu2023/fig08", [f"duration={duration}", "plant.hold=zero"]))
    over = Event()

    def answer_all(domain: int) -> None:
        with local_context(domain) as context:
            plain = Plain(composition.joint_names, context=context)
            executor = SingleThreadedExecutor(context=context)
            executor.add_node(plain)
            while not over.is_set():
                executor.spin_once(timeout_sec=0.1)
            executor.shutdown()
            plain.destroy_node()

    with reserved_domain() as domain:
        monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
        answering = Thread(target=answer_all, args=(domain,))
        answering.start()
        try:
            late = {"controller": DEADLINE}
            reason = run_processes(composition, tmp_path / "run", realtime=realtime, hooks=Hooks(), late=late)
        finally:
            over.set()
            answering.join()
    assert reason == "completed"
    found = efforts(tmp_path / "run")
    assert set(found) == {EFFORT}
    if realtime is None:
        assert len(found) == 81
    else:
        assert len(found) > 40


def test_one_that_is_late_gets_the_references_that_wait(tmp_path: Path) -> None:
    """In lock-step: those of the state that waits and of all that follow, though they were published before it came."""
    commands_alone(tmp_path / "run", later=0.3, kind=Joining)


def test_one_that_is_late_misses_no_reference_of_a_clock(tmp_path: Path) -> None:
    """Paced: it gets the reference of each state, but for a few before it was noticed; sixteen were out."""
    with running_graph(tmp_path / "run", "duration=12.0", "plant.hold=zero", roles=ALONE, realtime=4.0) as robot:
        robot.spin_for(0.3)
        joining = Joining(robot.composition.joint_names, context=robot.context)
        robot.executor.add_node(joining)
        end(robot)
        parts = joining.parts
        joining.destroy_node()
    heard_states = [stamp for stamp, names in parts.items() if BASE_ODOM.name in names]
    assert len(heard_states) > 20
    lacking = [stamp for stamp in heard_states if len(parts[stamp]) < 3]
    assert lacking == heard_states[: len(lacking)]
    assert len(lacking) < 8


class Renaming:
    """Sends a joint command as others do."""

    def __init__(self, publisher: Any) -> None:
        self._publisher = publisher

    def publish(self, command: Any) -> None:
        """Turn it round, with other joints."""
        command.header.frame_id = "world"
        command.name = ["gripper", *reversed(command.name), "camera"]
        command.effort = [9.0, *reversed(command.effort), 9.0]
        command.position = command.velocity = [0.0] * len(command.name)
        self._publisher.publish(command)


def test_joints_are_found_by_name(tmp_path: Path) -> None:
    """Any order, other joints, unused arrays, a frame: the run completes, its joints are logged in its own order."""

    def rename(plain: Plain) -> None:
        plain.joints = Renaming(plain.joints)

    commands_alone(tmp_path / "run", later=0.0, prepare=rename)


def test_who_does_not_match_is_named(tmp_path: Path) -> None:
    """A publisher of commands that is BEST_EFFORT, and one who asks for states of the past, with node and policy."""
    with running_graph(tmp_path / "run", "duration=4000.0", realtime=1.0) as robot:
        newest = heard(robot)
        sensor = Node("sensor", context=robot.context)
        sensor.create_publisher(JointState, JOINT_COMMAND.name, qos_profile_sensor_data)
        past = QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        sensor.create_subscription(Odometry, BASE_ODOM.name, lambda message: None, past)

        def named() -> bool:
            status = newest.get("simulator: commands")
            return (
                status is not None
                and "/sensor is not heard on /joint_command: offers reliability BEST_EFFORT, asked" in status.message
                and "/sensor does not hear /base/odom: offered durability VOLATILE, asked TRANSIENT" in status.message
            )

        robot.spin_until(named, "the warning")
        sensor.destroy_node()
    assert newest["simulator: commands"].level == DiagnosticStatus.WARN


def test_an_answer_that_is_repeated_is_no_warning(tmp_path: Path) -> None:
    """The same again is counted, and the commands are as they should be."""
    with running_graph(tmp_path / "run", "duration=5.0", roles=ALONE) as robot:
        newest = heard(robot)
        plain = Plain(robot.composition.joint_names, context=robot.context)
        robot.simulator.pause(True)
        robot.executor.add_node(plain)
        robot.await_answer()
        first = Odometry()
        plain.answer(first)
        plain.answer(first)
        robot.spin_until(lambda: "simulator: commands" in newest, "the status")
        newest.clear()
        robot.spin_until(lambda: "simulator: commands" in newest, "the next status")
        plain.destroy_node()
    status = newest["simulator: commands"]
    assert {value.key: value.value for value in status.values}["repeated"] == "4"
    assert status.level == DiagnosticStatus.OK, status.message
