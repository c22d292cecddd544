"""The node that stands in for the simulator: it publishes what a bag holds, as fast as it is answered or by a clock."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from typing import Any
from uuid import uuid4

from rclpy.clock import Clock
from rclpy.clock_type import ClockType

from space_robot_msgs_py.codec.codecs import encode_clock, encode_string
from space_robot_msgs_py.errors import CommandError, SilenceError
from space_robot_msgs_py.interfaces import Command
from space_robot_msgs_py.nodes.base import GraphNode
from space_robot_msgs_py.nodes.offers import Offers
from space_robot_msgs_py.qos import OF_A_STATE, qos_of_states
from space_robot_msgs_py.run_messages import RunBegin, encode_begin
from space_robot_msgs_py.topics import CLOCK, ROBOT_DESCRIPTION, RUN_BEGIN, TABLE, Topic
from space_robot_sim.nodes.command_port import CommandPort
from space_robot_sim.nodes.pacing import Pacer
from space_robot_sim.nodes.services import RunServices, StepGate

WATCH_SECONDS = 1.0

RecordedTick = tuple[int, Mapping[Topic, bytes]]


class ReplayerNode(GraphNode):
    """Publishes recorded ticks in place of the simulator, with its QoS, its ``~/pause``, ``~/step`` and ``~/reset``.

    Lock-step (``rate`` None): a tick is followed by the next when both parts of a command with its stamp are there.
    What the command says moves nothing: the next state is the recorded one.

    Timed: the steady clock advances, with or without answers.

    References go out before the state of their stamp.

    Args:
        ticks: stamp [ns] and messages by topic, in order; at least one.
        joint_names: names a command must carry.
        topics: what is published of them, besides ``/clock``.
        urdf: for ``robot_description``; empty: nothing is published there.
        period: recorded control period [ns].
        rate: recorded seconds per second; None: lock-step.
        paused: only ``~/step`` advances, until ``~/pause`` says otherwise.
        loop: after the last tick comes the first again; else the run ends with ``completed``.
        patience: lock-step ends with an error when an answer takes longer than this [s].
        on_answer: called with the stamp [ns] and the command of every answer (None: it could not be used).
        options: see GraphNode.
    """

    def __init__(
        self,
        ticks: Sequence[RecordedTick],
        joint_names: tuple[str, ...],
        *,
        topics: Collection[Topic],
        urdf: str = "",
        period: int,
        rate: float | None = None,
        paused: bool = False,
        loop: bool = False,
        patience: float = 60.0,
        on_answer: Callable[[int, Command | None], None] = lambda stamp, command: None,
        name: str = "replayer",
        **options: Any,
    ) -> None:
        super().__init__(name, **options)
        self._ticks, self._loop, self._patience, self._tell = ticks, loop, patience, on_answer
        # References first: a node that joins them with the state of their stamp has them by then.
        ranked = sorted(topics, key=lambda topic: (topic.kind != "reference", TABLE.index(topic)))
        # By a clock what was published stays, for displays.
        offers = {topic: None if rate else qos_of_states(topic, paced=False) for topic in ranked}
        self._sinks = {topic: self.publisher(topic, offer) for topic, offer in offers.items()}
        self._clock_publisher = self.publisher(CLOCK)
        if urdf:
            self._description_publisher = self.publisher(ROBOT_DESCRIPTION)
            self._description_publisher.publish(encode_string(urdf))
        self.index = 0
        self._gate = StepGate(paused=paused)
        self.commands = CommandPort(self, joint_names, self._on_answer, period=period) if rate is None else None
        self._offers = None
        if self.commands is not None:
            self._offers = Offers(self, self._waiting, self._say, self.commands.readers)
        self.pacer = None if rate is None else Pacer(self, period / rate, self._on_period)
        self._steering = RunServices(self)
        self._run = RunBegin(uuid4().hex[:16], -1)
        self._begin_publisher = self.publisher(RUN_BEGIN)
        self._steady, self._seen = Clock(clock_type=ClockType.STEADY_TIME), -1
        self._since = self._steady.now()
        self._watchdog = self.create_timer(WATCH_SECONDS, self._watch, clock=self._steady)
        self.reset()

    @property
    def stamp(self) -> int:
        """Stamp of the newest tick that was published [ns]."""
        return self._ticks[self.index][0]

    @property
    def paused(self) -> bool:
        """True while only ``~/step`` advances."""
        return self._gate.paused

    def pause(self, paused: bool) -> None:
        """Stop at the next tick, or go on."""
        self._gate.pause(paused)
        self._on_answer()

    def step_once(self) -> None:
        """While paused: publish one more tick, in lock-step as soon as the newest one is answered."""
        self._gate.grant()
        if self.commands is None:
            self._advance()
        else:
            self._on_answer()

    def reset(self) -> None:
        """Begin again with the first tick; every node is notified.

        Raises:
            CommandError: the run is over.
        """
        if self.end_reason is not None:
            raise CommandError("the run is over", key="~/reset", value=self.end_reason, accepted="a run in progress")
        self._run = replace(self._run, number=self._run.number + 1)
        self.runs[self._run.run] = self._run.number
        self._begin_publisher.publish(encode_begin(self._run))
        if self.commands is not None:
            self.commands.restart()
        if self.pacer is not None:
            self.pacer.restart()
        if self._offers is not None:
            self._offers.begin([sink for topic, sink in self._sinks.items() if topic.kind in OF_A_STATE])
        self._show(0)

    def _waiting(self) -> int | None:
        """Stamp of the newest tick where it waits for its answer."""
        return self.stamp if self.commands is not None and not self.commands.answered else None

    def _show(self, index: int) -> None:
        self.index = index
        stamp = self._ticks[index][0]
        if self.commands is not None:
            self.commands.expect(stamp)
        self._say()
        self._clock_publisher.publish(encode_clock(stamp))

    def _say(self) -> None:
        parts = self._ticks[self.index][1]
        for topic, sink in self._sinks.items():
            if topic in parts:
                sink.publish(parts[topic])

    def _on_answer(self) -> None:
        if self.commands is not None and self.commands.answered and self._may_advance():
            self._tell(self.stamp, self.commands.take())
            self._advance_to_next()

    def _on_period(self) -> None:
        if not self.paused:
            self._advance()

    def _advance(self) -> None:
        if self._may_advance():
            self._advance_to_next()

    def _may_advance(self) -> bool:
        return self.end_reason is None and self._gate.take()

    def _advance_to_next(self) -> None:
        if self.index + 1 < len(self._ticks):
            self._show(self.index + 1)
        elif self._loop:
            self.reset()
        else:
            self.end("completed")

    def _watch(self) -> None:
        """A lock-step run without answers ends with a reason instead of never."""
        now = self._steady.now()
        if self.index != self._seen or self.paused or self.commands is None or self.end_reason is not None:
            self._seen, self._since = self.index, now
        elif (now - self._since).nanoseconds > self._patience * 1e9:
            self.fail(
                SilenceError(
                    f"no command answers the state at {self.stamp} ns",
                    key="base/wrench_command, joint_command",
                    accepted="a controller on this domain, or --rate",
                )
            )
