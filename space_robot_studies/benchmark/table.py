"""Results as they are kept: a row per law, task and point, with every held-out draw, and where it came from."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from space_robot_bringup.compose.versions import versions
from space_robot_control.laws.registry import law_class
from space_robot_control.laws.source import source_of
from space_robot_msgs_py.atomic_file import write_atomically
from space_robot_msgs_py.errors import LogError, SpaceRobotError, SpecError
from space_robot_studies.benchmark.spec import Benchmark
from space_robot_studies.compare.comparison import METRICS
from space_robot_studies.engine.storage import guarded
from space_robot_studies.tune.outcome import StandResult
from space_robot_studies.tune.ranking import Evaluation
from space_robot_studies.tune.spec import Tuning

# References that come to rest somewhere else: what settled means is defined there alone.
ARRIVING = ("step", "quintic", "waypoints", "end_effector")
KEPT = ("objective", "end_reason", "excess", *METRICS)
MAX_BYTES = 100_000_000
SIDES = ("shipped", "tuned")
# Of every number of a draw: more would tell laws apart by their rounding errors, in all draws alike.
DIGITS = 7
FORM = ("law", "task", "point", "settles", "overfitted", "shipped", "tuned")


@dataclass(frozen=True, slots=True)
class Table:
    """Rows that were made under the same rules.

    Attributes:
        identity: see ``Benchmark.identity``.
        rows: by task, point and law, in the order in which they were entered.
    """

    identity: Mapping[str, Any]
    rows: tuple[Mapping[str, Any], ...] = ()

    def with_rows(self, rows: Sequence[Mapping[str, Any]]) -> Table:
        """These rows entered; those of the same law, task and point are replaced."""
        found = {key_of(row): row for row in self.rows} | {key_of(row): row for row in rows}
        return Table(self.identity, tuple(found.values()))

    def write(self, path: Path) -> None:
        """Keep it.

        Raises:
            LogError: it cannot be written.
        """
        head = json.dumps(dict(self.identity), indent=1).removesuffix("\n}")
        rows = ",\n".join(json.dumps(_stored(row), allow_nan=False) for row in self.rows)
        with guarded(path.parent):
            write_atomically(path, f'{head},\n "rows": [\n{rows}\n]}}\n')

    def to_dict(self) -> dict[str, Any]:
        """Plain data, as in the file: of the draws a list per number."""
        return {**self.identity, "rows": [_stored(row) for row in self.rows]}


def key_of(row: Mapping[str, Any]) -> tuple[str, str, str]:
    """Task, point and law of a row."""
    return row["task"], json.dumps(row["point"], sort_keys=True), row["law"]


def read_table(path: Path, benchmark: Benchmark) -> Table:
    """The table in a file that rows of this benchmark may be entered in; an empty one where there is no file.

    Raises:
        SpecError: it is none, or one of other tasks or rules.
        LogError: it cannot be read.
    """
    identity = benchmark.identity()
    with guarded(path.parent):
        if not path.exists():
            return Table(identity)
        if path.stat().st_size > MAX_BYTES:
            raise LogError("too large for a table", key=str(path), accepted=f"at most {MAX_BYTES} bytes")
        text = path.read_text(encoding="utf-8")
    try:
        data = json.loads(text)
        rows = tuple(_loaded(row) for row in data.pop("rows"))
        complete = all(set(FORM) <= row.keys() for row in rows)
    except (ValueError, KeyError, TypeError, AttributeError):
        complete = False
    if not complete:
        raise SpecError("is no table of a benchmark", key="--table", value=str(path), accepted="one, or a new file")
    if different := [name for name, value in identity.items() if data.get(name) != value]:
        what = f"was made under other rules (not the same: {', '.join(different)})"
        raise SpecError(what, key="--table", value=str(path), accepted="a table of this benchmark, or a new file")
    return Table(identity, rows)


def first_table(path: Path, file: Path, benchmark: Benchmark) -> Table:
    """The table in a file; where there is none, that beside the benchmark file if it was made under the same rules.

    Args:
        path: of the table.
        file: of the benchmark; ``v1.yaml`` has its results in ``v1.json``.
        benchmark: whose rows are to be entered.

    Raises:
        SpaceRobotError: see ``read_table``.
    """
    if path.exists():
        return read_table(path, benchmark)
    try:
        return read_table(file.with_suffix(".json"), benchmark)
    except SpecError:
        # A short part, or a set of the user's own beside something else.
        return Table(benchmark.identity())


def row_of(task: str, tuning: Tuning, stand: StandResult) -> dict[str, Any]:
    """What is kept of a law at a point of a task; the tuning is resolved."""
    experiment = tuning.experiment
    reference = experiment["reference"] if isinstance(experiment, dict) else {}
    return {
        "law": stand.name,
        "task": task,
        "point": dict(stand.labels),
        "settles": reference.get("kind") in ARRIVING,
        "class": stand.law.law,
        "source_sha256": _digest(stand.law.law),
        "given": {"gains": dict(stand.law.gains), "ranges": _ranges(stand)},
        "gains": dict(stand.best.gains),
        "edge": list(stand.at_the_edge),
        "overfitted": stand.overfitted,
        "shipped": _draws(stand.held_out_shipped),
        "tuned": _draws(stand.held_out_best),
        "versions": versions(),
    }


def _stored(row: Mapping[str, Any]) -> dict[str, Any]:
    """A row as it is written: one list per number of the draws, a third of the length of the draws one by one."""
    return {**row, **{side: {name: [draw[name] for draw in row[side]] for name in KEPT} for side in SIDES}}


def _loaded(row: Mapping[str, Any]) -> dict[str, Any]:
    """A row as it was before it was written."""
    return {**row, **{side: _unstacked(row[side]) for side in SIDES}}


def _unstacked(numbers: Mapping[str, Sequence[Any]]) -> list[dict[str, Any]]:
    stacked = [numbers[name] for name in KEPT]
    return [dict(zip(KEPT, draw, strict=True)) for draw in zip(*stacked, strict=True)]


def _ranges(stand: StandResult) -> dict[str, Any]:
    return {name: [one.low, one.high, one.scale] for name, one in stand.ranges.items()}


def _draws(one: Evaluation) -> list[dict[str, Any]]:
    return [{name: _kept(draw.get(name)) for name in KEPT} for draw in one.draws]


def _kept(value: Any) -> Any:
    return float(f"{value:.{DIGITS}g}") if isinstance(value, float) else value


def _digest(law: str) -> str | None:
    """Of the file of a custom law."""
    try:
        source = source_of(law_class(law))
    except SpaceRobotError:
        return None
    return None if source is None else source.digest
