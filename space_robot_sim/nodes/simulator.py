"""Simulator node: it publishes states and advances only on a command or the clock."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import replace
from typing import Any, cast
from uuid import uuid4

from space_robot_msgs_py.codec.codecs import encode_string
from space_robot_msgs_py.errors import CommandError
from space_robot_msgs_py.interfaces import Command, Plant, PlantSample, SupervisedPlant
from space_robot_msgs_py.nodes.managed import ManagedNode
from space_robot_msgs_py.nodes.offers import Offers
from space_robot_msgs_py.qos import Qos, qos_of_states
from space_robot_msgs_py.run_messages import RunBegin, encode_begin
from space_robot_msgs_py.topics import RECORDER_CREDIT, ROBOT_DESCRIPTION, RUN_BEGIN, Topic
from space_robot_sim.nodes.command_port import REPEATED, CommandPort
from space_robot_sim.nodes.credit import Credit
from space_robot_sim.nodes.health import SimulatorHealth, SimulatorStatus
from space_robot_sim.nodes.mode_port import ModePort
from space_robot_sim.nodes.pacing import REALTIME, Pacer, checked_factor, realtime_row
from space_robot_sim.nodes.sample_publishers import SamplePublishers
from space_robot_sim.nodes.services import STEP_COUNT, RunServices, StepGate, checked_count, step_count_row
from space_robot_sim.nodes.tick_parts import MAX_LATE
from space_robot_sim.nodes.turns import Turns


class SimulatorNode(ManagedNode):
    """Carries a plant through ``steps`` control periods.

    Lock-step (default): state k is published with stamp k T, and the plant steps when the command with that stamp is
    there, however long that takes. Where a recorder takes part, the run starts when it hears every node and never gets
    further ahead of it than its credit, so that nothing is lost.

    Paced (``realtime`` given): the steady clock advances the plant, a period without a command is run with the newest
    valid one, at most ``MAX_LATE`` periods old, or the plant's hold, and both are counted. The factor is the dynamic
    parameter ``realtime``. It waits for a recorder that does not keep up.

    Deactivated, time stands still; after cleanup the plant is built anew and the run starts again. Every start is
    announced on ``run_begin``, and a recorder gives new credit for it: what the run before was given counts no more.

    Args:
        make_plant: builds the true robot, each time the node is configured.
        joint_names: the robot's joints in model order.
        urdf: what goes on ``robot_description``.
        period: control period [ns].
        steps: number of periods of the run; states 0..steps are published, each is to be answered.
        realtime: simulated seconds per second of the steady clock; None: lock-step.
        recorded: a recorder takes part and gives credit.
        optional: the optional topics of this run, for the events of the plant and the momentum of the wheels.
        obeys: modes of a supervisor act on the plant (brakes, unloading): in lock-step it waits for them, too.
        ahead: so many states the run may be ahead of its recorder in lock-step.
        patience: lock-step ends with an error when the awaited command takes longer than this [s].
        step_count: so many periods ``~/step`` grants, a dynamic parameter.
        failover: periods without an answer after which the other one of two controllers takes over (paced); 0: there is
            one controller.
        options: see ManagedNode.
    """

    def __init__(
        self,
        make_plant: Callable[[], Plant],
        joint_names: tuple[str, ...],
        *,
        urdf: str,
        period: int,
        steps: int,
        realtime: float | None = None,
        recorded: bool = True,
        optional: Collection[Topic] = (),
        obeys: bool = False,
        ahead: int = 0,
        patience: float = 60.0,
        step_count: int = 1,
        failover: int = 0,
        name: str = "simulator",
        **options: Any,
    ) -> None:
        super().__init__(name, **options)
        self._make_plant, self._joint_names, self._urdf = make_plant, joint_names, urdf
        self._period, self._steps, self._patience = period, steps, patience
        self._realtime, self._recorded = None if realtime is None else checked_factor(realtime), recorded
        self._optional, self._ahead = optional, ahead
        self.tick = 0
        self.sample: PlantSample | None = None
        self.started = False
        self.on_tick: Callable[[int], None] = lambda tick: None
        self._gate, self._step_count = StepGate(), step_count
        self._run = RunBegin(uuid4().hex[:16], 0)
        self.runs[self._run.run] = 0
        # What comes while it is not configured is heard: nothing is sent twice.
        self._begin_publisher = self.publisher(RUN_BEGIN)
        self._credit = Credit(self)
        keep_late = 0 if realtime is None else MAX_LATE
        limits: dict[str, Any] = {"keep_late": keep_late, "turns": Turns(failover, period) if failover else None}
        self.commands = CommandPort(self, joint_names, self._on_answer, period=period, **limits)
        if recorded:
            self.listen(RECORDER_CREDIT, self._on_credit)
        self._modes = ModePort(self, self._on_answer, lossless=realtime is None) if obeys else None
        readers = [] if self._modes is None else self._modes.readers
        self._offers = Offers(self, self._waiting, self._say_again, [*self.commands.readers, *readers])
        self.keep()

    def configure(self) -> None:
        """Build the plant and listen; time stands still until it is activated."""
        self._plant = self._make_plant()
        self._gate = StepGate()
        self.commands.counts.clear()
        self._set_back(self._plant.reset())
        self._samples = SamplePublishers(self, self._joint_names, self._urdf, self._optional, self._offer)
        self._description_publisher = self.publisher(ROBOT_DESCRIPTION)
        self._description_publisher.publish(encode_string(self._urdf))
        self.pacer = Pacer(self, self._period / self._realtime, self._on_period) if self._realtime else None
        self.parameters.declare([realtime_row(self._realtime), step_count_row(self._step_count)])
        self._steering = RunServices(self, lambda: self._step_count)
        self._health = SimulatorHealth(self, self._status, self._patience)

    def activate(self) -> None:
        """Start as soon as the recorder hears every node, or go on."""
        if self.pacer is not None:
            self.pacer.restart()
        self._start()
        self._on_answer()

    def cleanup(self) -> None:
        """Forget the plant."""
        self._offers.stop()
        del self._plant

    def retune(self, changes: dict[str, Any]) -> None:
        """Take over another pace, from the next period on, or another number of steps.

        Raises:
            SpecError: not within the bounds of the parameter.
        """
        count = checked_count(changes.get(STEP_COUNT, self._step_count))
        if self.pacer is not None and REALTIME in changes:
            self._realtime = checked_factor(changes[REALTIME])
            self.pacer.pace(self._period / self._realtime)
        self._step_count = count

    @property
    def begun(self) -> bool:
        """True when the first state is out."""
        return self.started

    @property
    def period(self) -> int:
        """Control period [ns]."""
        return self._period

    @property
    def stamp(self) -> int:
        """Stamp of the state that waits for its answer [ns]."""
        return self.tick * self._period

    @property
    def paused(self) -> bool:
        """True while only ``~/step`` advances the plant."""
        return self._gate.paused

    def pause(self, paused: bool) -> None:
        """Stop at the next tick, or go on."""
        self._gate.pause(paused)
        self._on_answer()

    def step_once(self) -> None:
        """While paused: let the plant take one step as soon as its command is there."""
        self._gate.grant()
        self._on_answer()

    def reset(self) -> None:
        """Back to the initial state and stamp 0; what is under way from before is refused as out of date.

        At tick 0 there is nothing to go back from; steps that were granted and not taken are forgotten.

        Raises:
            CommandError: the run is over.
        """
        if self.end_reason is not None:
            raise CommandError("the run is over", key="~/reset", value=self.end_reason, accepted="a run in progress")
        self._gate.pause(self.paused)
        if self.tick > 0:
            self._set_back(self._plant.reset())
            self._start()

    def hear_begin(self, begin: RunBegin) -> None:
        """Only its own run is this node's."""
        if begin.run != self._run.run:
            self.refuse(RUN_BEGIN, f"a second simulator; this run is {self._run.run}, that one {begin.run}")

    def _status(self) -> SimulatorStatus:
        standing = self.paused or not self.active or self.end_reason is not None
        counts = self.commands.counts
        self.commands.accepted.look()
        unrecorded = self.started and self._outruns_recorder() and self.commands.answered
        matched = [*self.commands.readers, *self._samples.awaited]
        return SimulatorStatus(
            self.tick, self.stamp, self._period, self.started, standing, unrecorded, self.sample, counts, matched
        )

    def _set_back(self, sample: PlantSample) -> None:
        """Begin a run, which is announced to all nodes; the recorder waits for the first one of this node anyway."""
        if self.started:
            self._run = replace(self._run, number=self._run.number + 1)
            self.runs[self._run.run] = self._run.number
            self._credit.restart()
        self.sample, self.tick, self.started = sample, 0, False
        self.commands.restart()
        if self._modes is not None:
            self._modes.restart()
        self._begin_publisher.publish(encode_begin(self._run))

    def _on_credit(self, raw: bytes) -> None:
        if self._credit.take(raw, self.stamp, self._period) and self.configured:
            self._start()
            self._on_answer()

    def _offer(self, topic: Topic) -> Qos:
        return qos_of_states(topic, paced=self._realtime is not None, ahead=self._ahead)

    def _start(self) -> None:
        if self.active and not self.started and self.sample is not None and (self._credit.given or not self._recorded):
            if self.pacer is not None:
                self.pacer.restart()
            self._offers.begin(self._samples.awaited)
            self._show(self.sample)

    def _waiting(self) -> int | None:
        """Stamp of the newest state where it waits for its answer, or to be recorded; paced, for the first of that."""
        if not self.active or not self.started or self.end_reason is not None:
            return None
        waits = self._outruns_recorder() and (self.pacer is None or self.tick == 0)
        return self.stamp if waits or (self.pacer is None and not self._answered) else None

    def _show(self, sample: PlantSample) -> None:
        self.sample, self.started = sample, True
        self._samples.show(sample)

    def _say_again(self) -> None:
        if self.sample is not None:
            self._samples.say(self.sample)

    @property
    def _answered(self) -> bool:
        """All that is known before the plant runs on is here."""
        return self.commands.answered and (self._modes is None or self._modes.knows(self.stamp))

    def _on_answer(self) -> None:
        """Lock-step: go on as far as answers and pause allow."""
        if self.pacer is None and self._answered and self._may_advance():
            self._advance(self.commands.take())

    def _on_period(self) -> None:
        """Paced: one period of the steady clock has passed."""
        # As for messages: what goes wrong in a timer would be a traceback, and the others would not know.
        try:
            if self._may_advance():
                self._advance(self.commands.take_newest())
        except Exception as error:
            self.fail(error)

    def _may_advance(self) -> bool:
        if not self.active or self.end_reason is not None or not self.started:
            return False
        return not self._outruns_recorder() and self._gate.take()

    def _outruns_recorder(self) -> bool:
        """The next state would be further ahead of the log than the recorder allows; a paced run waits, too."""
        return self._recorded and self.tick < self._steps and self.stamp + self._period > self._credit.until

    def _advance(self, command: Command | None) -> None:
        if self.tick == self._steps:
            self._say_what_was_refused()
            self.end("completed")
            return
        if self._modes is not None:
            plant = cast(SupervisedPlant, self._plant)
            plant.close_brakes(self._modes.closed)
            plant.unload_wheels(self._modes.unloads)
        sample = self._plant.step(command)
        self.tick += 1
        self._health.count(sample)
        for event in sample.events:
            self.commands.counts[event.name] += 1
        self.commands.expect(self.stamp)
        self._show(sample)
        self.on_tick(self.tick)

    def _say_what_was_refused(self) -> None:
        """A run that deviated from its commands reports it; the numbers in the log cannot."""
        if counts := {name: n for name, n in self.commands.counts.items() if name != REPEATED}:
            what = ", ".join(f"{n} {name}" for name, n in sorted(counts.items()))
            self.get_logger().warning(f"commands refused or missed in {self._steps} periods: {what}")
