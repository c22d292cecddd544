"""A bag on the live graph: a node made of nothing but rclpy and standard messages is tested against it."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from time import monotonic
from typing import Any

import pytest

from tests.support.paths import ROOT

pytest.importorskip("rclpy")
from geometry_msgs.msg import WrenchStamped
from nav_msgs.msg import Odometry
from rclpy.context import Context
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from std_srvs.srv import SetBool, Trigger
from trajectory_msgs.msg import JointTrajectory

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.context import private_context, reserved_domain
from space_robot_bringup.modes.graph import LIGHT, make_executor, make_node
from space_robot_bringup.replay.comparison import EXACT
from space_robot_bringup.replay.publish import Answers, PublishOptions, open_broadcast
from space_robot_msgs_py.nodes.managed import bring_up
from space_robot_sim.nodes.replayer import ReplayerNode
from tests.support.follow import DEADLINE as PROCESS_SECONDS
from tests.support.follow import ended
from tests.support.forks import fork_main
from tests.support.replays import record_run
from tests.support.tool import Tool, refused

pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]
DEADLINE = 60.0
SHORT = "duration=5.0"
TICKS, PERIOD = 21, 250_000_000


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Five seconds of fig08."""
    return record_run(tmp_path_factory.mktemp("logs") / "run", "liu2023/fig08", SHORT)


class Stranger(Node):  # type: ignore[misc]
    """A third-party controller: it knows topic names, standard messages and a gain, nothing of this project."""

    def __init__(self, context: Context, answers: bool = True) -> None:
        super().__init__("stranger", context=context)
        latched = QoSProfile(depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.stamps: list[int] = []
        self.heard: dict[str, int] = {}
        self.commands: list[int] = []
        self._answers, self._odometry, self._requested = answers, dict[int, Odometry](), dict[int, JointTrajectory]()
        self._joints: dict[int, JointState] = {}
        self._wrench = self.create_publisher(WrenchStamped, "base/wrench_command", latched)
        self._effort = self.create_publisher(JointState, "joint_command", latched)
        for kind, topic, keep in (
            (Odometry, "base/odom", self._odometry),
            (JointState, "joint_states", self._joints),
            (JointTrajectory, "reference/joints", self._requested),
        ):
            self.create_subscription(kind, topic, self._taker(topic, keep), latched)
        self.create_subscription(String, "robot_description", self._description, latched)
        self.urdf = ""

    def _taker(self, topic: str, keep: dict[int, Any]) -> Callable[[Any], None]:
        def take(message: Any) -> None:
            stamp = message.header.stamp.sec * 1_000_000_000 + message.header.stamp.nanosec
            self.heard[topic] = self.heard.get(topic, 0) + 1
            keep[stamp] = message
            if all(stamp in kept for kept in (self._odometry, self._joints, self._requested)):
                self._answer(stamp, self._joints.pop(stamp), self._requested.pop(stamp))
                self._odometry.pop(stamp)

        return take

    def _answer(self, stamp: int, state: JointState, asked: JointTrajectory) -> None:
        self.stamps.append(stamp)
        if not self._answers:
            return
        wrench, effort = WrenchStamped(), JointState(name=state.name)
        wrench.header.stamp = effort.header.stamp = state.header.stamp
        wrench.header.frame_id = "base_link"
        effort.effort = [0.5 * (d - q) for d, q in zip(asked.points[0].positions, state.position, strict=True)]
        self._wrench.publish(wrench)
        self._effort.publish(effort)

    def _description(self, message: String) -> None:
        self.urdf = message.data


class Stage:
    """A replayer and what listens to it, under the test's control."""

    def __init__(self, replayer: ReplayerNode, other: Any, executor: Any, answers: Answers) -> None:
        self.replayer, self.other, self.executor, self.answers = replayer, other, executor, answers

    def until(self, condition: Callable[[], object], what: str) -> None:
        end = monotonic() + DEADLINE
        while not condition():
            self.executor.spin_once(timeout_sec=0.02)
            assert monotonic() < end, f"waited {DEADLINE} s for {what}; the replayer is at tick {self.replayer.index}"

    def call(self, service: Any, name: str, request: Any) -> Any:
        client = self.other.create_client(service, f"replayer/{name}")
        self.until(client.service_is_ready, f"service {name}")
        future = client.call_async(request)
        self.until(future.done, f"an answer of {name}")
        return future.result()

    def settle(self, seconds: float = 0.1) -> None:
        """Give everything that could happen the time to happen."""
        end = monotonic() + seconds
        while monotonic() < end:
            self.executor.spin_once(timeout_sec=0.01)


@contextmanager
def stage(bag: Path, other: Callable[[Context], Any] = Stranger, **order: Any) -> Iterator[Stage]:
    broadcast, how = open_broadcast(bag), PublishOptions(**order)
    answers = Answers(broadcast, EXACT)
    with private_context() as context:
        replayer = ReplayerNode(
            broadcast.ticks,
            broadcast.joint_names,
            topics=how.published,
            urdf=broadcast.urdf,
            period=broadcast.period,
            rate=how.pace,
            paused=how.paused,
            loop=how.loop,
            on_answer=answers.take,
            context=context,
            **LIGHT,
        )
        listener = other(context)
        executor = make_executor(context)
        for node in (replayer, listener):
            executor.add_node(node)
        try:
            yield Stage(replayer, listener, executor, answers)
        finally:
            executor.shutdown()
            for node in (replayer, listener):
                node.destroy_node()


def test_a_strangers_controller_answers_every_recorded_state(bag: Path) -> None:
    """In lock-step each state waits for its command; at the end every answer is compared with the recorded one."""
    with stage(bag) as on:
        on.until(lambda: on.replayer.end_reason, "the end of the bag")
        assert on.replayer.end_reason == "completed"
        assert on.other.stamps == [tick * PERIOD for tick in range(TICKS)]
        # Topics have no order among each other: the robot may come after the last state.
        on.until(lambda: on.other.urdf, "the robot")
        assert "<robot" in on.other.urdf
        assert on.answers.comparison.compared == {"base/wrench_command": TICKS, "joint_command": TICKS}
        assert on.answers.different


def test_the_recorded_law_answers_as_recorded(bag: Path) -> None:
    """The controller node on the replayed states says what it said in the run, bit for bit."""
    composition = compose(load_experiment("liu2023/fig08", [SHORT]))

    def own_controller(context: Context) -> Any:
        node = make_node("controller", composition, bag, realtime=None, mode="graph", context=context, **LIGHT)
        bring_up([node])
        return node

    with stage(bag, own_controller) as on:
        on.until(lambda: on.replayer.end_reason, "the end of the bag")
        assert on.answers.comparison.compared == {"base/wrench_command": TICKS, "joint_command": TICKS}
        assert not on.answers.different


def test_without_an_answer_the_state_stays(bag: Path) -> None:
    """Without answers the first state is published once and nothing follows; with little patience the run ends so."""
    with stage(bag, lambda context: Stranger(context, answers=False)) as on:
        on.until(lambda: on.other.stamps, "the first state")
        on.settle()
        assert on.replayer.index == 0
        on.replayer._patience = 0.0
        on.until(lambda: on.replayer.end_reason, "the end of patience")
        assert "no command answers the state at 0 ns" in str(on.replayer.end_reason)


@pytest.mark.parametrize("rate", [None, 100.0])
def test_a_paused_replayer_takes_single_steps(bag: Path, rate: float | None) -> None:
    """~/step gives one tick, ~/pause false the rest, ~/reset the first one again, in lock-step and timed."""
    with stage(bag, paused=True, rate=rate) as on:
        on.until(lambda: on.other.stamps == [0], "the first state")
        for tick in range(1, 4):
            assert on.call(Trigger, "step", Trigger.Request()).success
            on.until(lambda goal=tick: on.other.stamps[-1] == goal * PERIOD, "one more state")
            on.settle(0.05)
            assert on.replayer.index == tick
        assert on.call(Trigger, "reset", Trigger.Request()).success
        on.until(lambda: on.other.stamps[-1] == 0, "the first state again")
        assert on.call(SetBool, "pause", SetBool.Request(data=False)).success
        on.until(lambda: on.replayer.end_reason, "the end of the bag")
        assert on.other.stamps[-TICKS:] == [tick * PERIOD for tick in range(TICKS)]


def test_a_timed_replay_waits_for_no_answer(bag: Path) -> None:
    """With a rate the clock advances, whether or not a command comes; every state is published once, in order."""
    with stage(bag, lambda context: Stranger(context, answers=False), rate=50.0) as on:
        on.until(lambda: on.replayer.end_reason, "the end of the bag")
        on.until(lambda: len(on.other.stamps) == TICKS, "all states")
        assert on.other.stamps == [tick * PERIOD for tick in range(TICKS)]


def test_a_looped_replayer_begins_again(bag: Path) -> None:
    """After the last tick comes the first, and the end of the run is not announced."""
    with stage(bag, loop=True) as on:
        on.until(lambda: len(on.other.stamps) > 2 * TICKS, "a third round")
        rounds = on.other.stamps[: 2 * TICKS]
        assert rounds == 2 * [tick * PERIOD for tick in range(TICKS)]
        assert on.replayer.end_reason is None


def test_publish_sends_the_topics_of_the_option(bag: Path) -> None:
    """By default what a controller hears; with `all` its commands too, timed; with names only those."""
    names = {topic.name for topic in PublishOptions().published}
    assert {"base/odom", "joint_states", "base/imu", "reference/base", "plant/telemetry"} <= names
    assert names.isdisjoint({"base/wrench_command", "joint_command", "controller/telemetry"})
    everything = PublishOptions(role="all")
    assert {"base/wrench_command", "controller/telemetry"} <= {topic.name for topic in everything.published}
    assert (PublishOptions().pace, everything.pace) == (None, 1.0)
    with stage(bag, topics=("/base/odom",), rate=100.0) as on:
        on.until(lambda: on.replayer.end_reason, "the end of the bag")
        on.until(lambda: on.other.heard.get("base/odom") == TICKS, "the odometry")
        on.settle()
        assert on.other.heard == {"base/odom": TICKS}


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--publish", "--rate", "0"), ("--rate", "0.0")),
        (("--publish", "--as", "pilot"), ("--as", "pilot", "state")),
        (("--publish", "--topics", "base/odometer"), ("--topics", "base/odometer", "base/odom")),
        (("--rate", "2"), ("--publish",)),
        (("--loop",), ("--publish",)),
        (("--publish", "--set", "seed=1"), ("--set", "--publish")),
    ],
)
def test_bad_orders_get_one_line(
    space_robot: Tool, bag: Path, arguments: tuple[str, ...], words: tuple[str, ...]
) -> None:
    """A wrong option is named with what would do, exit 2."""
    refused(space_robot("replay", str(bag), *arguments), *words)


def test_the_tool_and_a_controller_process_meet(space_robot: Tool, bag: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """`replay --publish` against our controller in a process of its own: equal, exit 0."""
    with reserved_domain() as domain:
        monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
        options = ["--experiment", "liu2023/fig08", "--set", SHORT, "--out", "unused"]
        with ended([fork_main("space_robot_bringup.nodes.process", "controller", *options)]) as (controller,):
            done = space_robot("replay", str(bag), "--publish")
            assert controller.wait(timeout=PROCESS_SECONDS) == 0
    assert done.returncode == 0, done.stdout + done.stderr
    assert "answers: EQUAL, 42 messages" in done.stdout


def test_the_executable_publishes_a_bag(bag: Path) -> None:
    """`replayer BAG --rate` runs to the end of the bag and exits 0; without a bag it says so and exits 2."""
    executable = str(ROOT / "lib" / "space_robot_sim" / "replayer")
    with reserved_domain() as domain:
        path = f"{Path(sys.executable).parent}:{os.environ['PATH']}"
        environment = os.environ | {"ROS_DOMAIN_ID": str(domain), "PATH": path}
        for arguments, code in (((str(bag), "--rate", "100"), 0), (("nowhere",), 2)):
            command = ["sh", executable, *arguments]
            done = subprocess.run(
                command, env=environment, capture_output=True, text=True, check=False, timeout=PROCESS_SECONDS
            )
            assert done.returncode == code, done.stderr
    assert "nowhere" in done.stderr
