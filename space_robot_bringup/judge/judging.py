"""Metrics and verdict of a run of an experiment, from its ticks or from blocks of its log."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

from space_robot_bringup.experiment.expectations import AnyExpectation, bounds_of
from space_robot_bringup.judge.assertions import Assertions
from space_robot_bringup.judge.check import Check
from space_robot_bringup.judge.measure import Block, Measurement, tick_blocks
from space_robot_bringup.judge.metrics import RunMetrics
from space_robot_bringup.judge.remarks import Remark, Remarks
from space_robot_bringup.judge.signals import Rows
from space_robot_bringup.judge.verdict import check_end, check_ticks, judge
from space_robot_msgs_py.errors import SpaceRobotError
from space_robot_msgs_py.events import DiagnosticEvent
from space_robot_msgs_py.interfaces import Tick
from space_robot_msgs_py.log.arrays import LogArrays
from space_robot_msgs_py.log.blocks import Block as LogBlock
from space_robot_msgs_py.log.writer import MemorySink

if TYPE_CHECKING:
    from space_robot_bringup.compose.composition import Composition
    from space_robot_bringup.fused.sink import FusedRun

Lacking = Callable[[int], str]


class Judgement(NamedTuple):
    """What a run is judged to be.

    Attributes:
        metrics: None where no tick was completed.
        checks: the verdict, bound by bound.
        remarks: what else happened, whatever was expected.
    """

    metrics: RunMetrics | None
    checks: tuple[Check, ...]
    remarks: tuple[Remark, ...] = ()


def _nothing_known(tick: int) -> str:
    del tick
    return ""


class Judge:
    """Takes the complete ticks of a run block by block; ``verdict`` judges all of them.

    Args:
        composition: of the experiment that was run.
        expect: instead of what the experiment expects, checked, see ``check_expect``.
    """

    def __init__(self, composition: Composition, expect: Mapping[str, AnyExpectation] | None = None) -> None:
        nominal, experiment = composition.nominal, composition.experiment
        self._experiment = experiment
        self._expect = experiment.expect if expect is None else expect
        self._assertions = Assertions(self._expect, nominal, experiment)
        self._measurement = Measurement(
            composition.joint_names,
            base_translation=nominal.base_mode == "free_flying",
            prismatic=nominal.prismatic,
            bands=experiment.settling_bands,
        )
        self._remarks = Remarks(nominal, experiment.period, experiment.plant.delay_periods)
        self._pending: tuple[DiagnosticEvent, ...] = ()
        self._refusal: SpaceRobotError | None = None

    def add(self, block: Block, events: Iterable[DiagnosticEvent] = ()) -> None:
        """Take the next ticks and what happened at them; what cannot be judged is an error of ``verdict``."""
        if self._refusal is None:
            stamps, plant, q_d, v_d = block
            try:
                self._measurement.add(*block)
                self._remarks.add(stamps, plant, v_d)
                self._assertions.add(stamps, Rows(plant, q_d, v_d), events)
            except SpaceRobotError as error:
                self._refusal = error

    def add_log(self, block: LogBlock) -> None:
        """``add`` for a block of a log; what happened at ticks that do not fit the robot is not forgotten."""
        if block.arrays is not None:
            self.add(log_block(block.arrays), (*self._pending, *block.diagnostics))
            self._pending = ()
        else:
            self._pending += block.diagnostics

    def verdict(self, reason: str, lacks: Lacking = _nothing_known) -> Judgement:
        """Metrics, verdict and remarks of the run; no metrics where no tick was completed.

        Args:
            reason: of the end.
            lacks: says what a tick lacks that is not complete.

        Raises:
            SpaceRobotError: the ticks lack the telemetry that metrics are made of, or are of another robot, or a metric
                is not finite.
        """
        if self._refusal is not None:
            raise self._refusal
        experiment, stamps = self._experiment, self._measurement.stamps
        whole = check_ticks(stamps, experiment.steps, experiment.period, lacks)
        if not stamps.size:
            return Judgement(None, (check_end(reason), whole, *self._assertions.checks()))
        metrics = self._measurement.result()
        ended, *others = judge(metrics, bounds_of(self._expect), reason)
        checks = (ended, whole, *others, *self._assertions.checks())
        return Judgement(metrics, checks, self._remarks.found())


def judge_ticks(ticks: Sequence[Tick], composition: Composition, reason: str) -> Judgement:
    """``Judge`` for a run in memory.

    Args:
        ticks: the complete ones.
        composition: of the experiment that was run.
        reason: of the end.

    Raises:
        SpaceRobotError: the ticks lack the telemetry that metrics are made of, or a metric is not finite.
    """
    judging = Judge(composition)
    events = [event for tick in ticks for event in tick.diagnostics]
    for block in tick_blocks(ticks):
        judging.add(block, events)
        events = []
    return judging.verdict(reason)


def judge_memory(sink: MemorySink | FusedRun, composition: Composition) -> Judgement:
    """``judge_ticks`` for what ``run_in_memory`` returns.

    Args:
        sink: closed.
        composition: of the experiment that was run.

    Raises:
        SpaceRobotError: see ``judge_ticks``.
    """
    reason = sink.end_reason or ""
    if isinstance(sink, MemorySink):
        return judge_ticks(sink.ticks, composition, reason)
    judging = Judge(composition)
    judging.add(log_block(sink.arrays))
    return judging.verdict(reason)


def log_block(arrays: LogArrays) -> Block:
    """What ``Judge.add`` takes, of a block of a log."""
    return arrays.stamp, arrays.plant, arrays.q_d, arrays.v_d


def judge_blocks(
    blocks: Iterable[LogBlock],
    composition: Composition,
    reason: str,
    lacks: Lacking = _nothing_known,
    expect: Mapping[str, AnyExpectation] | None = None,
) -> Judgement:
    """``Judge`` for a log.

    Args:
        blocks: see ``LogReader.event_blocks``.
        composition: of the experiment that was run.
        reason: of the end.
        lacks: says what a tick lacks that is not complete.
        expect: instead of what the experiment expects, see ``Judge``.

    Raises:
        SpaceRobotError: the log cannot be read, lacks the telemetry that metrics are made of, or a metric is not
            finite.
    """
    judging = Judge(composition, expect)
    for block in blocks:
        judging.add_log(block)
    return judging.verdict(reason, lacks)
