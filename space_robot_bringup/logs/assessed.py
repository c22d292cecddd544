"""A log as far as it can be read: what is left of a damaged one, and what it says about itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from space_robot_bringup.compose.composition import Composition
from space_robot_bringup.experiment.experiment import Experiment
from space_robot_bringup.judge.metrics import RunMetrics
from space_robot_bringup.judge.verdict import Check
from space_robot_bringup.logs.logged import compose_logged, logged_experiment
from space_robot_bringup.modes.run import judge_ticks
from space_robot_msgs_py.codec.codecs import TickCodec
from space_robot_msgs_py.errors import LogError, SpaceRobotError
from space_robot_msgs_py.events import ControllerEvent
from space_robot_msgs_py.interfaces import NANOSECONDS, Tick
from space_robot_msgs_py.log.arrays import LogArrays, Row, stack_ticks
from space_robot_msgs_py.log.directory import custom_data
from space_robot_msgs_py.log.header import LogHeader
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.paths import StrPath


@dataclass(frozen=True, eq=False, slots=True)
class JudgedLog:
    """A log that was read once.

    Attributes:
        path: the .mcap file.
        header: provenance.
        mode: headless, graph or processes; empty where nothing says it.
        end_reason: None if the log was truncated.
        arrays: its complete ticks, stacked.
        experiment: None where the one in the log cannot be read here.
        composition: None where the experiment cannot be composed here.
        metrics: None without a composition.
        checks: the verdict, bound by bound; empty without a composition.
        events: what was changed during the run, in order.
        troubles: what is wrong with the log, a line each; empty for a whole one.
    """

    path: Path
    header: LogHeader
    mode: str
    end_reason: str | None
    arrays: LogArrays
    experiment: Experiment | None
    composition: Composition | None
    metrics: RunMetrics | None
    checks: tuple[Check, ...]
    events: tuple[ControllerEvent, ...]
    troubles: tuple[str, ...]


def read_judged(path: StrPath) -> JudgedLog:
    """Read a log, whole or corrupted.

    Args:
        path: run directory or .mcap file.

    Raises:
        InputFileError: there is no such log.
        LogError: it is not a run log, or no complete tick can be read.
    """
    reader = LogReader(path)
    troubles: list[str] = []
    rows, ticks = _readable(reader, troubles)
    if not ticks:
        why = f": {troubles[0]}" if troubles else ""
        raise LogError(f"no complete tick can be read{why}", key=str(path))
    arrays = stack_ticks(rows, reader.header.joint_names, str(path))
    end_reason = _end_reason(reader, troubles)
    if end_reason is None:
        troubles.append(f"the log was truncated: what is here ends at {arrays.time[-1]:g} s, and why is not known")
    experiment, composition = _experiment(reader.header, troubles)
    metrics, checks = _judge(ticks, composition, end_reason, troubles)
    return JudgedLog(
        path=reader.path,
        header=reader.header,
        mode=_mode(reader.path),
        end_reason=end_reason,
        arrays=arrays,
        experiment=experiment,
        composition=composition,
        metrics=metrics,
        checks=checks,
        events=tuple(event for tick in ticks for event in tick.output.events),
        troubles=tuple(troubles),
    )


def _readable(reader: LogReader, troubles: list[str]) -> tuple[list[Row], list[Tick]]:
    """The complete ticks up to the first damage that can be seen."""
    codec = TickCodec(reader.header.joint_names)
    rows, ticks, unfit = list[Row](), list[Tick](), list[str]()
    try:
        for stamp, parts in reader.rows():
            try:
                ticks.append(codec.decode(parts))
                rows.append((stamp, parts))
            except SpaceRobotError as error:
                unfit.append(f"tick at {stamp / NANOSECONDS:g} s left out: {error}")
    except LogError as error:
        troubles.append(str(error))
    troubles += unfit[:1]
    if len(unfit) > 1:
        troubles.append(f"{len(unfit) - 1} more ticks left out")
    return rows, ticks


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


def _judge(
    ticks: Sequence[Tick], composition: Composition | None, end_reason: str | None, troubles: list[str]
) -> tuple[RunMetrics | None, tuple[Check, ...]]:
    if composition is None:
        return None, ()
    try:
        return judge_ticks(ticks, composition, end_reason or "cut")
    except (SpaceRobotError, ValueError) as error:
        # A log of another plant may lack the telemetry that metrics are made of.
        troubles.append(f"no verdict: {error}")
        return None, ()


def _mode(path: Path) -> str:
    """From the metadata beside the bag: the mode changes no bit of the log, so the log does not know it."""
    return custom_data(path).get("mode", "")
