"""One case run: what a worker does, and nothing that depends on which worker it is."""

from __future__ import annotations

import traceback
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Any, Literal

from space_robot_bringup.compose.composition import Composition, compose, compose_world
from space_robot_bringup.experiment.experiment import experiment_from
from space_robot_bringup.fused.sink import FusedRun
from space_robot_bringup.judge.conclusion import passed
from space_robot_bringup.judge.judging import judge_memory
from space_robot_bringup.modes.headless import run_in_memory, write_bag
from space_robot_control.laws.policy import TYPED
from space_robot_description.kernel import jit
from space_robot_msgs_py.errors import SpaceRobotError
from space_robot_msgs_py.log.writer import MemorySink
from space_robot_studies.campaign.known_robots import known_robot
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
    sink: MemorySink | FusedRun = MemorySink()
    try:
        composition = _composed(data, name)
        sink = run_in_memory(composition)
        columns = _columns(composition, sink)
    except SpaceRobotError as error:
        columns = failure(f"error: {error}")
    except (Exception, SystemExit) as error:
        columns, trace = failure(bug(error)), traceback.format_exc()
    wanted = composition is not None and _kept(columns, keep)
    bag = _bag(composition, sink, name) if wanted and composition is not None else {}
    return CaseResult(columns, bag, trace, perf_counter() - began)


def run_cases(cases: Sequence[tuple[Mapping[str, Any], str, Keep]]) -> list[CaseResult | None]:
    """Run several experiments side by side where that can be; see ``run_case``.

    Args:
        cases: its arguments.

    Returns:
        Results in their order; None: only ``run_case`` can tell.

    Raises:
        LogError: a bag could not be written here.
    """
    if not jit.MACHINE_CODE:
        return [None for _ in cases]
    # Only here: it needs a compiler.
    from space_robot_bringup.fused.lanes import compiled_runs

    began = perf_counter()
    composed = [_composed_or_none(data, name) for data, name, _ in cases]
    runs = iter(compiled_runs([one for one in composed if one is not None]))
    found = [
        None if one is None else _result(one, next(runs), *case[1:]) for one, case in zip(composed, cases, strict=True)
    ]
    each = (perf_counter() - began) / len(cases)
    return [None if one is None else replace(one, wall_time=each) for one in found]


def _composed(data: Mapping[str, Any], name: str) -> Composition:
    """Without a look at the law before: what cannot be made of it shows when it is made to run."""
    return compose_world(experiment_from(data, name), TYPED, known_robot)


def _composed_or_none(data: Mapping[str, Any], name: str) -> Composition | None:
    try:
        return _composed(data, name)
    except SpaceRobotError:
        return None


def _result(composition: Composition, sink: FusedRun | None, name: str, keep: Keep) -> CaseResult | None:
    """What came of a run; None where it cannot be judged either."""
    if sink is None:
        return None
    try:
        columns = _columns(composition, sink)
    except (Exception, SystemExit):
        return None
    return CaseResult(columns, _bag(composition, sink, name) if _kept(columns, keep) else {}, "", 0.0)


def _kept(columns: Mapping[str, Any], keep: Keep) -> bool:
    return keep == "all" or (keep == "failed" and columns["passed"] is False)


def warm(data: Mapping[str, Any], laws: bytes = b"") -> None:
    """Load, or compile, what runs of an experiment need: plant and law are made.

    Args:
        data: the experiment.
        laws: of the program that asks, see ``packed_laws``.
    """
    unpack_laws(laws)
    composition = compose(experiment_from(data, "first case"), TYPED, known_robot)
    composition.plant().reset()
    # Only here: they load a compiler.
    from space_robot_bringup.fused.run import compiled_run

    if compiled_run(composition, 2) is not None:
        from space_robot_bringup.fused.lanes import compiled_runs

        compiled_runs([composition, composition], 2)


def _columns(composition: Composition, sink: MemorySink | FusedRun) -> dict[str, Any]:
    metrics, checks, remarks = judge_memory(sink, composition)
    reason = sink.end_reason or ""
    outcome = {
        "end_reason": reason,
        "completed": reason == "completed",
        "passed": passed(checks),
        "failed": ", ".join(check.name for check in checks if not check.passed),
        "remarks": ", ".join(remark.name for remark in remarks),
        "ticks": metrics.ticks if metrics is not None else 0,
    }
    return outcome | (metrics.flat() if metrics is not None else {})


def failure(reason: str) -> dict[str, Any]:
    """Columns of a case that nothing can be measured of."""
    outcome = {"end_reason": reason, "completed": False, "passed": False, "failed": "completed"}
    return outcome | {"remarks": "", "ticks": 0}


def _bag(composition: Composition, sink: MemorySink | FusedRun, name: str) -> dict[str, bytes]:
    """The bag a headless run would have left, as bytes: the campaign's folder may be on another machine."""
    with TemporaryDirectory(prefix="space-robot-") as scratch:
        place = Path(scratch) / name
        write_bag(sink, composition, place)
        return {path.name: path.read_bytes() for path in sorted(place.iterdir())}
