"""Set-points from a node with the default quality of service of ROS move the robot; bad ones change nothing."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("rclpy")
from builtin_interfaces.msg import Duration
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import PoseStamped, Twist
from rclpy.node import Node
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.run import run_experiment
from space_robot_bringup.replay.golden import update_reference
from space_robot_bringup.replay.recording import open_recording
from space_robot_bringup.replay.replay import ReplayOptions, replay
from space_robot_control.nodes import follow_trajectory, live_guidance
from space_robot_control.nodes.follow_trajectory import TrajectoryAction
from space_robot_control.nodes.live_guidance import LiveGuidanceNode
from space_robot_control.references.trajectory import Trajectory
from space_robot_msgs_py.codec.codecs import ReferenceCodec
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.set_points import BASE_GOAL, JOINT_TRAJECTORY, TELEOP, TOOL_GOAL
from tests.support.diagnostics import heard, numbers
from tests.support.harness import RunningGraph, running_graph

pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]
CASE, LIVE = "point_to_point/ur5_sat", "reference={kind: live}"
CLASSES = {JOINT_TRAJECTORY: JointTrajectory, BASE_GOAL: PoseStamped, TOOL_GOAL: PoseStamped, TELEOP: Twist}


class Outside:
    """What other programs publish with: ``create_publisher(T, topic, 10)``."""

    def __init__(self, robot: RunningGraph) -> None:
        self.robot, self.node = robot, Node("outside", context=robot.context)
        self.publishers = {topic: self.node.create_publisher(CLASSES[topic], topic.name, 10) for topic in CLASSES}
        robot.spin_until(lambda: all(one.get_subscription_count() for one in self.publishers.values()), "guidance")
        guidance = robot.nodes["guidance"]
        assert isinstance(guidance, LiveGuidanceNode)
        self.guidance = guidance

    def say(self, topic: Any, message: Any) -> None:
        """Publish, and spin until guidance has taken or refused it."""
        before = self.taken(topic)
        self.publishers[topic].publish(message)
        self.robot.spin_until(lambda: self.taken(topic) > before, f"{topic.name} at guidance")

    def taken(self, topic: Any) -> int:
        """How many messages of a topic guidance has had."""
        return self.guidance.accepted[topic.name] + self.guidance.refusals[topic.name]


@contextmanager
def outside(place: Path, *overrides: str, realtime: float | None = None) -> Iterator[Outside]:
    """A run that set-points move, paused at a state that has its answer, and a node that says some."""
    with running_graph(place, LIVE, *overrides, experiment=CASE, realtime=realtime) as robot:
        robot.simulator.pause(True)
        robot.await_answer()
        made = Outside(robot)
        try:
            yield made
        finally:
            made.node.destroy_node()


def references(place: Path, names: tuple[str, ...]) -> list[Any]:
    """Desired joint positions of every stamp of a log, also of those that no command answers."""
    codec = ReferenceCodec(names)
    rows = [[parts.get(topic.name) for topic in codec.topics] for _, parts in LogReader(place).stamps()]
    return [codec.decode([raw for raw in row if raw]).q[7:] for row in rows if all(row)]


def finish(robot: RunningGraph) -> None:
    """Go on to the end of the run and of the log."""
    robot.simulator.pause(False)
    robot.spin_until(lambda: robot.recorder.end_reason, "the end of the run")
    robot.settle()
    robot.recorder.finish(str(robot.recorder.end_reason))


def trajectory(names: tuple[str, ...], positions: list[float], seconds: int = 4) -> JointTrajectory:
    """One point, as ``ros2 topic pub`` would send it."""
    point = JointTrajectoryPoint(positions=positions, velocities=[0.0] * len(positions))
    point.time_from_start = Duration(sec=seconds)
    return JointTrajectory(joint_names=list(names), points=[point])


@pytest.mark.parametrize("realtime", [None, 20.0])
def test_a_trajectory_moves_the_arm(tmp_path: Path, realtime: float | None) -> None:
    """In lock-step and paced the arm follows it; the log has what was made of it as references, and replays exactly."""
    with outside(tmp_path / "run", "duration=10.0", realtime=realtime) as said:
        names = said.robot.composition.joint_names
        start = said.robot.composition.initial[0][7:]
        goal = start + 0.1
        said.say(JOINT_TRAJECTORY, trajectory(names[::-1], goal[::-1].tolist()))
        assert said.guidance.accepted == {JOINT_TRAJECTORY.name: 1}
        finish(said.robot)
    desired = references(tmp_path / "run", names)
    assert desired[0].tolist() == start.tolist()
    assert desired[-1].tolist() == goal.tolist()
    assert replay(tmp_path / "run", ReplayOptions()).equal
    if realtime is None:
        arrays = LogReader(tmp_path / "run").arrays()
        np.testing.assert_allclose(arrays.q[-1, 7:], goal, atol=0.02)
        assert not update_reference(open_recording(tmp_path / "run")), "the same run is another file"
        again = load_experiment(CASE, ["duration=10.0", f"reference={{kind: recorded, log: {tmp_path / 'run'}}}"])
        run_experiment(again, tmp_path / "again", mode="headless")
        assert np.array_equal(LogReader(tmp_path / "again").arrays().q, arrays.q)


def test_base_tool_and_hand_move_the_robot(tmp_path: Path) -> None:
    """A goal of the base, one of the tool, then the tool by hand: each is accepted, and seen in the references."""
    with outside(tmp_path / "run", "duration=60.0", "reference.base_rate_deg=3.0") as said:
        guidance, live = said.guidance, said.guidance.reference
        goal = PoseStamped()
        goal.pose.orientation.z, goal.pose.orientation.w = 0.05, 1.0
        said.say(BASE_GOAL, goal)
        said.robot.simulator.pause(False)
        said.robot.spin_until(lambda: live.doing == "at rest", "the base at its goal")
        said.robot.simulator.pause(True)
        said.robot.await_answer()
        pose = live.tool
        tool = PoseStamped()
        tool.header.frame_id = "inertial"
        tool.pose.position.x, tool.pose.position.y, tool.pose.position.z = (pose.position + 0.01).tolist()
        x, y, z, w = pose.quaternion
        tool.pose.orientation.x, tool.pose.orientation.y, tool.pose.orientation.z, tool.pose.orientation.w = x, y, z, w
        said.say(TOOL_GOAL, tool)
        said.robot.simulator.pause(False)
        said.robot.spin_until(lambda: live.doing == "at rest", "the tool at its goal")
        said.robot.simulator.pause(True)
        said.robot.await_answer()
        twist = Twist()
        twist.linear.x = 0.01
        said.say(TELEOP, twist)
        assert not guidance.refusals
        finish(said.robot)
    arrays = LogReader(tmp_path / "run").arrays()
    assert arrays.q_d[-1, 5] == pytest.approx(0.05 / np.hypot(0.05, 1.0))
    assert replay(tmp_path / "run", ReplayOptions()).equal


def test_bad_set_points_are_refused_and_counted_with_their_reasons(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Joint, number, time, frame, reach, bytes: each is a count and a reason on /diagnostics, and the run completes."""
    monkeypatch.setattr(live_guidance, "DIAGNOSTICS_PERIOD", 0.05)
    with outside(tmp_path / "run", "duration=10.0") as said:
        newest, names = heard(said.robot), said.robot.composition.joint_names
        start = said.robot.composition.initial[0][7:].tolist()
        backwards = trajectory(names, start)
        backwards.points = [*backwards.points, *backwards.points]
        frame, far = PoseStamped(), PoseStamped()
        frame.header.frame_id, far.pose.position.x = "map", 50.0
        nan = Twist()
        nan.linear.x = float("nan")
        bad = [
            (JOINT_TRAJECTORY, trajectory(("elbow", *names[1:]), start), "no such joint"),
            (JOINT_TRAJECTORY, trajectory(names, [float("nan")] * 6), "finite"),
            (JOINT_TRAJECTORY, trajectory(names, [90.0] * 6), "limits"),
            (JOINT_TRAJECTORY, backwards, "times do not increase"),
            (JOINT_TRAJECTORY, JointTrajectory(), "each once"),
            (BASE_GOAL, frame, "wrong frame"),
            (TOOL_GOAL, far, "a tool Jacobian"),
            (TELEOP, nan, "finite"),
        ]
        for topic, message, why in bad:
            said.say(topic, message)
            assert why in said.guidance.reasons.newest[topic.name], why
        said.robot.publish(TOOL_GOAL, b"\x00\x01\x00\x00\x01")
        wanted = {"refused_joint_trajectory": "5", "refused_base/goal": "1", "refused_tool/goal": "2"}

        def counted() -> bool:
            status = newest.get("guidance: set-points")
            return status is not None and wanted.items() <= numbers(status).items()

        said.robot.spin_until(counted, "the counts")
        status = newest["guidance: set-points"]
        assert status.level == DiagnosticStatus.WARN
        assert "geometry_msgs/msg/PoseStamped" in numbers(status)["reason_tool/goal"]
        finish(said.robot)
        assert said.robot.simulator.end_reason == "completed"
    arrays = LogReader(tmp_path / "run").arrays()
    assert (arrays.q_d == arrays.q_d[0]).all()


def test_a_reset_brings_the_reference_back(tmp_path: Path) -> None:
    """After it the robot holds its initial configuration, as at the start."""
    with outside(tmp_path / "run", "duration=10.0") as said:
        names, start = said.robot.composition.joint_names, said.robot.composition.initial[0][7:]
        said.say(JOINT_TRAJECTORY, trajectory(names, (start + 0.1).tolist(), seconds=1))
        said.robot.simulator.step_once()
        said.robot.spin_until(lambda: said.robot.simulator.tick > 0, "a step")
        said.robot.simulator.reset()
        finish(said.robot)
    arrays = LogReader(tmp_path / "run_reset1").arrays()
    assert (arrays.q_d[:, 7:] == start).all()


class Handle:
    """A goal of the action, as rclpy hands it out."""

    def __init__(self) -> None:
        self.request, self.ended = SimpleNamespace(trajectory=JointTrajectory()), list[str]()

    def succeed(self) -> None:
        self.ended.append("succeeded")

    def abort(self) -> None:
        self.ended.append("aborted")

    def canceled(self) -> None:
        self.ended.append("canceled")


@pytest.fixture
def action(monkeypatch: pytest.MonkeyPatch) -> tuple[TrajectoryAction, list[str]]:
    """The action on a machine that has control_msgs, and what was done in its name; a trajectory ends at 10 ns."""
    calls: list[str] = []
    result = SimpleNamespace(Result=SimpleNamespace)
    monkeypatch.setattr(follow_trajectory, "import_module", lambda name: SimpleNamespace(FollowJointTrajectory=result))
    monkeypatch.setattr(follow_trajectory, "ActionServer", lambda *arguments, **options: calls.append(arguments[2]))

    def follow(trajectory: Trajectory) -> int:
        if calls[-1] == "refuse":
            raise SpecError("no such joint")
        made.replace()
        return 10

    node: Any = SimpleNamespace(refuse=lambda topic, why: calls.append(f"refused {topic.name}"))
    made = TrajectoryAction(node, follow, lambda: calls.append("stop"))
    return made, calls


def begun(action: TrajectoryAction, handle: Handle) -> Any:
    """The coroutine of a goal, run until it waits; its result is that of the iteration's end."""
    coroutine = action.execute(handle)
    coroutine.send(None)
    return coroutine


def result_of(coroutine: Any) -> Any:
    """What a goal ended with."""
    with pytest.raises(StopIteration) as end:
        coroutine.send(None)
    return end.value.value


def test_the_action_ends_as_joint_trajectory_controller_does(action: tuple[TrajectoryAction, list[str]]) -> None:
    """Succeeded at the time of its last point, aborted when replaced, cancelled, or refused with the reason."""
    server, calls = action
    assert calls == ["~/follow_joint_trajectory"]
    first, second, third, bad = Handle(), Handle(), Handle(), Handle()
    one = begun(server, first)
    two = begun(server, second)
    assert (result_of(one).error_code, first.ended) == (-1, ["aborted"])
    server.look(9)
    assert not second.ended
    server.look(10)
    assert (result_of(two).error_code, second.ended) == (0, ["succeeded"])
    three = begun(server, third)
    server.cancel(third)
    result_of(three)
    assert (third.ended, calls[-1]) == (["canceled"], "stop")
    calls.append("refuse")
    with pytest.raises(StopIteration) as end:
        server.execute(bad).send(None)
    assert (end.value.value.error_string, bad.ended) == ("no such joint", ["aborted"])
    assert calls[-1] == "refused joint_trajectory"
