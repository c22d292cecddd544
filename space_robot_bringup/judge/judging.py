"""Metrics and verdict of a run of an experiment, from its ticks or from blocks of its log."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING

from space_robot_bringup.judge.measure import Block, Measurement, tick_blocks
from space_robot_bringup.judge.metrics import RunMetrics
from space_robot_bringup.judge.verdict import Check, check_end, check_ticks, judge
from space_robot_msgs_py.errors import SpaceRobotError
from space_robot_msgs_py.interfaces import Tick
from space_robot_msgs_py.log.arrays import LogArrays

if TYPE_CHECKING:
    from space_robot_bringup.compose.composition import Composition

Lacking = Callable[[int], str]
Judgement = tuple[RunMetrics | None, tuple[Check, ...]]


def _nothing_known(tick: int) -> str:
    del tick
    return ""


class Judge:
    """Takes the complete ticks of a run block by block; ``verdict`` judges all of them.

    Args:
        composition: of the experiment that was run.
    """

    def __init__(self, composition: Composition) -> None:
        nominal = composition.nominal
        self._experiment = composition.experiment
        self._measurement = Measurement(
            composition.joint_names,
            base_translation=nominal.base_mode == "free_flying",
            prismatic=nominal.prismatic,
            bands=composition.experiment.settling_bands,
        )
        self._refusal: SpaceRobotError | ValueError | None = None

    def add(self, block: Block) -> None:
        """Take the next ticks, see ``Measurement.add``; what cannot be judged is an error of ``verdict``."""
        if self._refusal is None:
            try:
                self._measurement.add(*block)
            except (SpaceRobotError, ValueError) as error:
                self._refusal = error

    def verdict(self, reason: str, lacks: Lacking = _nothing_known) -> Judgement:
        """Metrics and verdict of the run; no metrics where no tick was completed.

        Args:
            reason: of the end.
            lacks: says what a tick lacks that is not complete.

        Raises:
            SpaceRobotError: the ticks lack the telemetry that metrics are made of, or a metric is not finite.
            ValueError: the ticks are of another robot.
        """
        if self._refusal is not None:
            raise self._refusal
        experiment, stamps = self._experiment, self._measurement.stamps
        whole = check_ticks(stamps, experiment.steps, experiment.period, lacks)
        if not stamps.size:
            return None, (check_end(reason), whole)
        metrics = self._measurement.result()
        ended, *others = judge(metrics, experiment.expect, reason)
        return metrics, (ended, whole, *others)


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
    for block in tick_blocks(ticks):
        judging.add(block)
    return judging.verdict(reason)


def log_block(arrays: LogArrays) -> Block:
    """What ``Judge.add`` takes, of a block of a log."""
    return arrays.stamp, arrays.plant, arrays.q_d, arrays.v_d


def judge_blocks(
    blocks: Iterable[LogArrays], composition: Composition, reason: str, lacks: Lacking = _nothing_known
) -> Judgement:
    """``Judge`` for a log.

    Args:
        blocks: see ``LogReader.blocks``.
        composition: of the experiment that was run.
        reason: of the end.
        lacks: says what a tick lacks that is not complete.

    Raises:
        SpaceRobotError: the log cannot be read, lacks the telemetry that metrics are made of, or a metric is not
            finite.
    """
    judging = Judge(composition)
    for block in blocks:
        judging.add(log_block(block))
    return judging.verdict(reason, lacks)
