"""One case run: what a worker does, and nothing that depends on which worker it is."""

from __future__ import annotations

import traceback
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Any, Literal

from space_robot_bringup.compose.composition import Composition, compose
from space_robot_bringup.experiment.experiment import experiment_from
from space_robot_bringup.judge.conclusion import passed
from space_robot_bringup.judge.judging import judge_ticks
from space_robot_bringup.modes.headless import run_in_memory, write_bag
from space_robot_msgs_py.errors import SpaceRobotError
from space_robot_msgs_py.interfaces import Tick
from space_robot_msgs_py.log.writer import MemorySink
from space_robot_studies.campaign.session_laws import unpack_laws
from space_robot_studies.engine.worker import bug

Keep = Literal["failed", "all", "none"]


@dataclass(frozen=True, slots=True)
class CaseResult:
    """What a worker hands back.

    Attributes:
        columns: end_reason, completed, passed (null: nothing was expected of the task), failed (names of the bounds
            missed), remarks (names of what else happened), ticks, then every metric.
        bag: file name to content of the run directory, where the run is kept.
        trace: of a run that raised what it should not.
        wall_time: [s]; it depends on the machine and belongs in no table.
    """

    columns: Mapping[str, Any]
    bag: Mapping[str, bytes]
    trace: str
    wall_time: float


def run_case(data: Mapping[str, Any], name: str, keep: Keep) -> CaseResult:
    """Run one experiment headless and judge it; whatever goes wrong in it is its result.

    Args:
        data: the experiment.
        name: of the run directory.
        keep: whose bags come back.

    Raises:
        LogError: the bag could not be written here; another worker may manage.
    """
    began = perf_counter()
    composition, trace = None, ""
    sink = MemorySink()
    try:
        composition = compose(experiment_from(data, name))
        sink = run_in_memory(composition)
        columns = _columns(composition, sink.end_reason or "", sink.ticks)
    except SpaceRobotError as error:
        columns = failure(f"error: {error}")
    except (Exception, SystemExit) as error:
        columns, trace = failure(bug(error)), traceback.format_exc()
    wanted = keep == "all" or (keep == "failed" and columns["passed"] is False)
    bag = _bag(composition, sink, name) if wanted and composition is not None else {}
    return CaseResult(columns, bag, trace, perf_counter() - began)


def warm(data: Mapping[str, Any], laws: bytes = b"") -> None:
    """Load, or compile, what runs of an experiment need: plant and law are made.

    Args:
        data: the experiment.
        laws: of the program that asks, see ``packed_laws``.
    """
    unpack_laws(laws)
    composition = compose(experiment_from(data, "first case"))
    composition.plant().reset()


def _columns(composition: Composition, reason: str, ticks: Sequence[Tick]) -> dict[str, Any]:
    metrics, checks, remarks = judge_ticks(ticks, composition, reason)
    outcome = {
        "end_reason": reason,
        "completed": reason == "completed",
        "passed": passed(checks),
        "failed": ", ".join(check.name for check in checks if not check.passed),
        "remarks": ", ".join(remark.name for remark in remarks),
        "ticks": len(ticks),
    }
    return outcome | (metrics.flat() if metrics is not None else {})


def failure(reason: str) -> dict[str, Any]:
    """Columns of a case that nothing can be measured of."""
    outcome = {"end_reason": reason, "completed": False, "passed": False, "failed": "completed"}
    return outcome | {"remarks": "", "ticks": 0}


def _bag(composition: Composition, sink: MemorySink, name: str) -> dict[str, bytes]:
    """The bag a headless run would have left, as bytes: the campaign's folder may be on another machine."""
    with TemporaryDirectory(prefix="space-robot-") as scratch:
        place = Path(scratch) / name
        write_bag(sink, composition, place)
        return {path.name: path.read_bytes() for path in sorted(place.iterdir())}
