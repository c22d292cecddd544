"""The benchmark: one table for all laws, the same rows however it is cut, and only what tests separate."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("cmaes")
pytest.importorskip("scipy")

from space_robot_bringup.experiment.readable import dump_yaml
from space_robot_cli.main import main
from space_robot_msgs_py.errors import SpecError
from space_robot_studies.benchmark.digest import digest_of
from space_robot_studies.benchmark.knowledge import NOTHING, knowledge_of
from space_robot_studies.benchmark.overview import overview_of
from space_robot_studies.benchmark.page import page_of
from space_robot_studies.benchmark.ranking import Standing, rank
from space_robot_studies.benchmark.run import BenchmarkResult, laws_of, run_benchmark
from space_robot_studies.benchmark.spec import load_benchmark
from space_robot_studies.benchmark.table import Table, read_table
from space_robot_studies.tune.stand import make_stands
from space_robot_studies.tune.tune import check_task
from tests.support.paths import ROOT
from tests.support.tool import Tool, refused

SET: dict[str, Any] = {
    "title": "A short move",
    "version": 3,
    "rules": {"budget": 3, "draws": 1, "held_out": 3, "seed": 4},
    "vary": {"control_period": [0.25, 0.5]},
    "laws": {"computed_torque": {"gains": {"bandwidth": 0.3}}, "pd": {"gains": {"bandwidth": 0.2}}},
    "tasks": {
        "move": {
            "title": "Move",
            "experiment": "compare/mini",
            "set": {"duration": 3.0, "reference.duration": 2.0, "reference.joints_by_deg": 2},
            "disperse": {"plant.payload.mass": {"uniform": {"low": 0.8, "high": 1.2}}},
        },
        "hold": {"experiment": "compare/mini", "set": {"duration": 2.0, "reference": {"kind": "hold"}}},
    },
    "short": {"tasks": ["move"], "laws": ["pd"], "vary": {"control_period": [0.5]}, "rules": {"budget": 1}},
}


LABELS = ("known", "unknown")


def write(folder: Path, **changes: Any) -> Path:
    path = folder / "set.yaml"
    path.write_text(dump_yaml(SET | changes), encoding="utf-8")
    return path


def run(path: Path, out: Path, *names: str, only: tuple[str, ...] = (), **options: Any) -> BenchmarkResult:
    benchmark = load_benchmark(path, only=only)
    return run_benchmark(benchmark, path, out, laws=laws_of(benchmark, names, path.parent), workers=1, **options)


@pytest.fixture(scope="module")
def judged(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, BenchmarkResult]:
    """The laws of the set on the first of its tasks."""
    folder = tmp_path_factory.mktemp("judged")
    path = write(folder)
    return path, run(path, folder / "out", tasks=("move",))


def test_a_point_alone_gives_the_rows_of_the_whole(judged: tuple[Path, BenchmarkResult], tmp_path: Path) -> None:
    """Draws, searches and held-out runs of a law are the same whatever other points and laws are run with it."""
    path, whole = judged
    part = run(path, tmp_path / "part", "pd", only=("control_period=0.5",), tasks=("move",))
    (alone,) = part.table.rows
    assert alone in whole.table.rows
    assert len(whole.table.rows) == 4


def test_numbers_that_differ_by_rounding_are_equal_in_a_table(judged: tuple[Path, BenchmarkResult]) -> None:
    """Seven digits of each: laws that do the same would else differ, in all draws alike."""
    rows = judged[1].table.rows
    numbers = [draw["objective"] for row in rows for side in ("shipped", "tuned") for draw in row[side]]
    assert len(set(numbers)) > len(rows)
    assert numbers == [float(f"{one:.7g}") for one in numbers]


def test_a_custom_law_is_entered_in_the_table_of_the_others(
    judged: tuple[Path, BenchmarkResult], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """``--law file.py:Class --table FILE`` adds its rows with the digest of its source, and ranks it."""
    path, whole = judged
    table, page = tmp_path / "table.json", tmp_path / "page.md"
    table.write_bytes((whole.directory / "table.json").read_bytes())
    law = f"{ROOT / 'examples' / 'my_law.py'}:PdPlus"
    options = ["--law", law, "--task", "move", "--only", "control_period=0.5", "--workers", "1"]
    where = ["--table", str(table), "--out", str(tmp_path / "out"), "--markdown", str(page)]
    monkeypatch.setattr("sys.argv", ["space-robot", "benchmark", str(path), *options, *where])
    with pytest.raises(SystemExit) as end:
        main()
    assert end.value.code == 0
    rows = read_table(table, load_benchmark(path)).rows
    assert rows[:4] == whole.table.rows
    assert (rows[4]["law"], rows[4]["class"]) == ("pd_plus", law)
    assert len(rows[4]["source_sha256"]) == 64
    text = page.read_text()
    assert text.count("`pd_plus`") >= 2
    assert "3 evaluations of 1 draws, judged on 3 held-out draws" in text


def test_settled_is_said_only_where_the_reference_comes_to_rest(
    judged: tuple[Path, BenchmarkResult], tmp_path: Path
) -> None:
    """A hold and a wave have no settling time: their cells have a dash, not 0 of N."""
    path, whole = judged
    held = run(path, tmp_path / "hold", "pd", only=("control_period=0.5",), tasks=("hold",))
    assert [row["settles"] for row in held.table.rows] == [False]
    assert "| - | - |" in page_of(held.table, {})
    assert all(row["settles"] for row in whole.table.rows)


def test_a_further_axis_keeps_what_is_known(judged: tuple[Path, BenchmarkResult], tmp_path: Path) -> None:
    """A value without a label is the point that was there before: same row, same table; the other one is beside it."""
    _, whole = judged
    wheels = {"vary": {"nominal.wheels": {"": True, "unknown": False}}}
    path = write(tmp_path, tasks=SET["tasks"] | {"move": SET["tasks"]["move"] | wheels})
    (tmp_path / "table.json").write_bytes((whole.directory / "table.json").read_bytes())
    options: dict[str, Any] = {"only": ("control_period=0.5",), "tasks": ("move",), "table": tmp_path / "table.json"}
    both = run(path, tmp_path / "both", "computed_torque", **options)
    assert both.table.rows[:4] == whole.table.rows
    (more,) = both.table.rows[4:]
    assert more["point"] == {"control_period": 0.5, "nominal.wheels": "unknown"}
    page = knowledge_of(both.table, {"move": "Move"})
    assert "| Move |  | 0.5 | " in page
    assert page.count("Move") == 1
    assert knowledge_of(whole.table, {}) == f"{NOTHING}\n"


def row(law: str, objectives: Any, **point: Any) -> dict[str, Any]:
    """A row with these objectives."""
    draws = [{"objective": v, "excess": None if v is None else 0.0} for v in np.asarray(objectives).tolist()]
    given = [draw | {"objective": None if draw["objective"] is None else 2.0 * draw["objective"]} for draw in draws]
    return {"law": law, "task": "move", "point": point, "tuned": draws, "shipped": given, "edge": ["k"] * (law == "b")}


def test_at_a_glance_no_law_is_before_another_that_is_not_separated() -> None:
    """Bold are the best law and what is not separated from it; a law with a draw that ended has no rank."""
    base = np.linspace(1.0, 2.0, 20)
    near = base + np.where(np.arange(20) % 2, 0.011, -0.01)
    rows = [row("a", base), row("b", near), row("c", 2 * base), row("d", np.append(base[:19], None))]
    (line,) = [line for line in overview_of(Table({}, tuple(rows)), {}).splitlines() if line.startswith("| move")]
    assert [cell.strip() for cell in line.split("|")[4:-1]] == ["**1**", "**1**", "2", "(1/20)"]


def test_what_knowledge_is_worth_is_said_only_where_it_is_separated() -> None:
    """Points that differ in what is known alone: bold apart from zero, plain if not, empty where a draw ended."""
    base = np.linspace(1.0, 2.0, 20)
    near = base + np.where(np.arange(20) % 2, 0.011, -0.01)
    pairs = {"a": (base, base + 0.3), "b": (base, near), "c": (base, np.append(base[:19], None))}
    rows = [row(law, side, load=label) for law, both in pairs.items() for label, side in zip(LABELS, both, strict=True)]
    (line,) = [line for line in knowledge_of(Table({}, tuple(rows)), {}).splitlines() if line.startswith("| move")]
    a, b, c = (cell.strip() for cell in line.split("|")[4:-1])
    assert a.startswith("**0.3")
    assert b.startswith("0.0005 [-")
    assert c == ""


def test_a_digest_counts_what_is_separated_and_what_has_no_rank() -> None:
    """Medians over points by period and over all; what ended at a point has no ratio there."""
    base = np.linspace(1.0, 2.0, 20)
    near = base + np.where(np.arange(20) % 2, 0.011, -0.01)
    worse = {0.1: 2.0, 0.5: 4.0}
    rows = []
    for label in LABELS:
        for period, factor in worse.items():
            point = {"control_period": period, "load": label}
            third = np.append(base[:19], None) if label == "unknown" else 3 * base
            objectives = {"a": base, "b": near if label == "known" else factor * base, "c": third}
            rows += [row(law, found, **point) for law, found in objectives.items()]
    lines = [
        [cell.strip() for cell in line.split("|")[2:-1]]
        for line in digest_of(Table({}, tuple(rows)), {}).splitlines()
        if line.startswith("| `")
    ]
    by_period, by_task, knowledge = lines[:3], lines[3:6], lines[6:]
    assert by_period == [
        ["1 (2/2)", "1 (2/2)", "1 (4/4)", "0", "2", "0"],
        ["1.5 (1/2)", "2.5 (1/2)", "1.5 (2/4)", "0", "2", "4"],
        ["3 (0/2)", "3 (0/2)", "3 (0/4)", "2", "2", "0"],
    ]
    assert by_task == [["1"], ["1.5"], ["3"]]
    assert knowledge == [["1 (0 and 0 of 2)"], ["3 (2 and 0 of 2)"], ["-"]]


def test_only_what_pairs_separate_is_said() -> None:
    """A law that is worse in every draw is worse; one that is worse in some is not; one that ended is named apart."""
    rng = np.random.default_rng(1)
    base = rng.uniform(1.0, 2.0, size=20)
    noisy = base + rng.normal(scale=0.1, size=20)

    def standing(law: str, values: Any) -> Standing:
        numbers = [None if v is None else float(v) for v in values]
        return Standing.of(law, [{"objective": v, "excess": None if v is None else 0.0} for v in numbers])

    laws = [
        standing("best", np.minimum(base, noisy) - 0.001),
        standing("near", np.minimum(base, noisy) - 0.001 + 0.02 * np.sign(rng.normal(size=20)).clip(-0.9, 1.0)),
        standing("worse", base + 0.3),
        standing("ended", [*base[:19], None]),
    ]
    ranking = rank(laws)
    assert {ranking.best, *ranking.equal} == {"best", "near"}
    assert ranking.worse is not None
    assert list(ranking.worse) == ["worse"]
    assert ranking.worse["worse"].low > 0.2
    assert ranking.failed == ("ended",)
    assert rank(laws[3:]).best is None


def test_every_task_of_the_shipped_set_can_be_run_by_every_law() -> None:
    """At its last point, and in the short part: experiments, references, draws, ranges and gains fit."""
    for short in (False, True):
        benchmark = load_benchmark("v1", short=short)
        for task in benchmark.tasks:
            tuning = benchmark.tuning(task, benchmark.laws, ROOT / "config" / "benchmarks" / "v1.yaml")
            stands = make_stands(tuning)
            assert len(stands) == len(benchmark.laws) * len(tuning.points)
            check_task(tuning, tuning.campaign(), stands[-len(benchmark.laws) :])


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--law", "pid"), ("--law", "pd")),
        (("--task", "mov"), ("--task", "move")),
        (("--only", "control_period=0.3"), ("control_period", "0.25, 0.5")),
        (("--only", "period=1"), ("--only", "control_period")),
        (("--table", "set.yaml"), ("--table", "no table")),
    ],
)
def test_what_cannot_be_meant_is_one_line(
    space_robot: Tool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, options: tuple[str, ...], words: tuple[str, ...]
) -> None:
    """The option that was typed and what is accepted; exit 2, nothing written."""
    path = write(tmp_path)
    monkeypatch.chdir(tmp_path)
    refused(space_robot("benchmark", str(path), *options), *words)
    assert [one.name for one in tmp_path.iterdir()] == ["set.yaml"]


def test_a_table_of_other_rules_is_refused(judged: tuple[Path, BenchmarkResult], tmp_path: Path) -> None:
    """Results of another budget, version or task do not stand beside these."""
    _, whole = judged
    table = whole.directory / "table.json"
    for changes in ({"rules": SET["rules"] | {"budget": 4}}, {"version": 4}, {"tasks": {"hold": SET["tasks"]["hold"]}}):
        with pytest.raises(SpecError, match="under other rules"):
            read_table(table, load_benchmark(write(tmp_path, **changes)))
    assert len(read_table(table, load_benchmark(write(tmp_path))).rows) == 4
