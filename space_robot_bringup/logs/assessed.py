"""A log as far as it can be read: what is left of a damaged one, and what it says about itself."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from space_robot_bringup.compose.composition import Composition
from space_robot_bringup.experiment.experiment import Experiment
from space_robot_bringup.judge.check import Check
from space_robot_bringup.judge.conclusion import conclusion
from space_robot_bringup.judge.judging import Judge, Judgement
from space_robot_bringup.judge.metrics import RunMetrics
from space_robot_bringup.judge.remarks import Remark
from space_robot_bringup.logs.happened import MAX_EVENTS, Happened, Witness
from space_robot_bringup.logs.logged import compose_logged, logged_experiment
from space_robot_bringup.logs.spans import Spans
from space_robot_msgs_py.errors import LogError, SpaceRobotError
from space_robot_msgs_py.events import ControllerEvent
from space_robot_msgs_py.interfaces import NANOSECONDS
from space_robot_msgs_py.log.arrays import LogArrays, Row
from space_robot_msgs_py.log.blocks import BlockStacker
from space_robot_msgs_py.log.directory import custom_data
from space_robot_msgs_py.log.header import LogHeader
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.log.thinning import Thinner
from space_robot_msgs_py.paths import StrPath


@dataclass(frozen=True, eq=False, slots=True)
class JudgedLog:
    """A log that was read once.

    Attributes:
        path: the .mcap file.
        header: provenance.
        mode: headless, graph or processes; empty where nothing says it.
        end_reason: None if the log was truncated.
        ticks: how many complete ones it has.
        arrays: its complete ticks, stacked; of a long log some, see ``Thinner``.
        experiment: None where the one in the log cannot be read here.
        composition: None where the experiment cannot be composed here.
        metrics: of all ticks; None without a composition.
        checks: the verdict, bound by bound; empty without a composition.
        remarks: what else happened, whatever was expected.
        events: what was changed in the run, in order; the first 10,000.
        happened: what was changed and what happened, in order; the first 10,000.
        troubles: what is wrong with the log, a line each; empty for a whole one.
        absent: ``reference`` and ``command`` where a bag of another tool has none; the reference is then the state, the
            command zero.
    """

    path: Path
    header: LogHeader
    mode: str
    end_reason: str | None
    ticks: int
    arrays: LogArrays
    experiment: Experiment | None
    composition: Composition | None
    metrics: RunMetrics | None
    checks: tuple[Check, ...]
    remarks: tuple[Remark, ...]
    events: tuple[ControllerEvent, ...]
    happened: tuple[Happened, ...]
    troubles: tuple[str, ...]
    absent: frozenset[str] = frozenset()

    @property
    def conclusion(self) -> str:
        """``PASS``, ``FAIL``, or in words that nothing was expected; empty without a composition."""
        return conclusion(self.checks) if self.checks else ""

    @property
    def spans(self) -> Spans:
        """The modes and faults of the run over time."""
        return Spans.of(self.happened, self.experiment, float(self.arrays.time[-1]))


def read_judged(path: StrPath) -> JudgedLog:
    """Read a log, whole or corrupted.

    Args:
        path: run directory or .mcap file.

    Raises:
        InputFileError: there is no such log.
        LogError: it is not a run log, or no complete tick can be read.
    """
    reader = LogReader(path)
    found: list[str] = []
    experiment, composition = _experiment(reader.header, found)
    reading = _Reading(reader, composition)
    arrays, troubles = reading.thinner.arrays(), reading.troubles
    if arrays is None:
        why = f": {troubles[0]}" if troubles else ""
        raise LogError(f"no complete tick can be read{why}", key=str(path))
    end_reason = _end_reason(reader, troubles)
    if end_reason is None:
        troubles.append(f"the log was truncated: what is here ends at {arrays.time[-1]:g} s, and why is not known")
    judged = reading.judged(end_reason or "cut", found)
    return JudgedLog(
        path=reader.path,
        header=reader.header,
        mode=_mode(reader.path),
        end_reason=end_reason,
        ticks=reading.thinner.ticks,
        arrays=arrays,
        experiment=experiment,
        composition=composition,
        metrics=judged.metrics,
        checks=judged.checks,
        remarks=judged.remarks,
        events=tuple(reading.events),
        happened=tuple(reading.witness.events),
        troubles=(*troubles, *found),
    )


class _Reading:
    """One pass over a log up to the first damage that can be seen.

    Args:
        reader: of the log.
        composition: what it is judged by; None: it is not.

    Attributes:
        thinner: has the ticks, as far as they are drawn.
        events: what was changed in the run.
        witness: knows what happened.
        troubles: what is wrong with the log.

    Raises:
        LogError: the shape of telemetry changes in the course of the log.
    """

    def __init__(self, reader: LogReader, composition: Composition | None) -> None:
        self._judge = Judge(composition) if composition is not None else None
        self.thinner = Thinner()
        self.events: list[ControllerEvent] = []
        self.troubles: list[str] = []
        self.witness = Witness(self._rows(reader))
        self._unfit, first = 0, ""
        for block in BlockStacker(reader.header.joint_names, str(reader.path)).blocks(self.witness.rows()):
            self.events += block.events[: MAX_EVENTS - len(self.events)]
            if block.unfit and not first:
                stamp, error = block.unfit[0]
                first = f"tick at {stamp / NANOSECONDS:g} s left out: {error}"
            self._unfit += len(block.unfit)
            if block.arrays is not None:
                self.thinner.add(block.arrays)
            if self._judge is not None:
                self._judge.add_log(block)
        self._tell(first)

    def judged(self, reason: str, troubles: list[str]) -> Judgement:
        """Metrics and verdict; why there is none is added to the troubles."""
        if self._judge is None:
            return Judgement(None, ())
        try:
            return self._judge.verdict(reason)
        except SpaceRobotError as error:
            # A log of another plant may lack the telemetry that metrics are made of.
            troubles.append(f"no verdict: {error}")
            return Judgement(None, ())

    def _rows(self, reader: LogReader) -> Iterator[Row]:
        try:
            yield from reader.rows()
        except LogError as error:
            self.troubles.append(str(error))

    def _tell(self, unfit: str) -> None:
        self.troubles += [unfit] if unfit else []
        if self._unfit > 1:
            self.troubles.append(f"{self._unfit - 1} more ticks left out")
        if self.thinner.thinned:
            self.troubles.append(f"{self.thinner.ticks} ticks: all are judged, some are drawn, every peak among them")


def _end_reason(reader: LogReader, troubles: list[str]) -> str | None:
    try:
        return reader.end_reason
    except LogError as error:
        troubles.append(str(error))
        return None


def _experiment(header: LogHeader, troubles: list[str]) -> tuple[Experiment | None, Composition | None]:
    experiment = None
    try:
        experiment = logged_experiment(header.experiment)
        return experiment, compose_logged(experiment)
    except SpaceRobotError as error:
        troubles.append(f"no verdict: the experiment in the log cannot be composed here: {error}")
        return experiment, None


def _mode(path: Path) -> str:
    """From the metadata beside the bag: the mode changes no bit of the log, so the log does not know it."""
    return custom_data(path).get("mode", "")
