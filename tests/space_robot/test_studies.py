"""`space_robot.campaign`, `compare`, `benchmark` and `reproduce`: what the commands do, as calls with results."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import space_robot as sr
from space_robot_cli.main import main
from space_robot_msgs_py import SpecError
from space_robot_studies.engine.hooks import StudyHooks
from space_robot_studies.reproduce.summary import summary

pq = pytest.importorskip("pyarrow.parquet")
pytest.importorskip("distributed")

pytestmark = pytest.mark.xdist_group("campaign")

CAMPAIGN = """
experiment: compare/mini
set: {duration: 2.0, reference.duration: 1.0, reference.joints_by_deg: 1}
runs: 2
seed: 3
disperse: {initial.angular_velocity: {direction: {low: 0.0, high: 0.002}}}
vary: {controller.law: [computed_torque, pd]}
"""
BENCHMARK = """
version: 1
rules: {budget: 2, draws: 1, held_out: 2}
vary: {control_period: [0.25, 0.5]}
laws: {pd: {gains: {bandwidth: 0.2}}}
tasks:
  move: {experiment: compare/mini, set: {duration: 2.0, reference.duration: 1.0, reference.joints_by_deg: 1}}
"""
MANIFEST = """
title: A paper
citation: "Anon, Tests 1, 2023"
figures:
  8:
    title: Orientation
    runs: {real: {experiment: liu2023/fig08, set: {duration: 6.0}}}
    claims:
      - paper: It arrives.
        measures: {late: {signal: base.error, take: max, after: 5.0, of: real}}
        holds_if: late < 1
        found: "{late:.2f} deg"
        expect: holds
"""


def tool(monkeypatch: pytest.MonkeyPatch, *words: str) -> object:
    """The exit code of a command."""
    monkeypatch.setattr(sys, "argv", ["space-robot", *words])
    with pytest.raises(SystemExit) as end:
        main()
    return end.value.code


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A working directory with a campaign and a manifest."""
    (tmp_path / "small.yaml").write_text(CAMPAIGN, encoding="utf-8")
    (tmp_path / "set.yaml").write_text(BENCHMARK, encoding="utf-8")
    (tmp_path / "paper.yaml").write_text(MANIFEST, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_campaign_is_that_of_the_command_line(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The same table, in the same place where none is said; it can be resumed."""
    done = sr.campaign(folder / "small.yaml", runs=1, workers=1)
    assert (done.end_reason, done.done, done.directory) == ("completed", 2, Path("runs/small"))
    assert [group.labels for group in done.groups] == [{"controller.law": law} for law in ("computed_torque", "pd")]
    with pytest.raises(SpecError, match=r"^out: holds a campaign; .*accepted: resume, or a new"):
        sr.campaign("small.yaml", workers=1)
    more = sr.campaign("small.yaml", out="runs/small", workers=1, resume=True)
    assert (more.done, more.passed, more.conclusion) == (4, None, "completed, nothing was expected")
    assert tool(monkeypatch, "campaign", "small.yaml", "--out", "other", "--workers", "1") == 0
    tables = [pq.read_table(folder / place / "table.parquet") for place in ("runs/small", "other")]
    assert tables[0].equals(tables[1])


def test_a_comparison_is_that_of_the_command_line(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One file, as text or Path, or several: the numbers are those that the command writes."""
    done = sr.compare(folder / "small.yaml", out=str(folder / "mine"), runs=1, workers=1)
    assert (done.end_reason, done.passed) == ("completed", True)
    (comparison,) = done.comparisons
    assert comparison.laws == ["computed_torque", "pd"]
    assert done.costs["small"].keys() == {"computed_torque", "pd"}
    assert tool(monkeypatch, "compare", "small.yaml", "--out", "theirs", "--runs", "1", "--workers", "1") == 0
    written = [json.loads((folder / place / "compare.json").read_text()) for place in ("mine", "theirs")]
    assert written[0] == written[1] == json.loads(json.dumps(done.to_dict()))


def test_a_comparison_that_was_stopped_compares_nothing(folder: Path) -> None:
    """A reason to stop ends it with that reason; nothing is said about the laws."""
    from space_robot_studies.engine.hooks import StudyHooks

    hooks = StudyHooks(stop=lambda: "interrupted")
    done = sr.compare(["small.yaml"], out="mine", runs=1, workers=1, hooks=hooks)
    assert (done.end_reason, done.comparisons, done.passed) == ("interrupted", (), False)


def test_a_benchmark_is_that_of_the_command_line(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The same table, bit for bit; a part of it has the rows of the whole, and a stopped one says so."""
    pytest.importorskip("cmaes")
    done = sr.benchmark(folder / "set.yaml", out="mine", workers=1)
    assert (done.end_reason, done.passed, len(done.table.rows)) == ("completed", True, 2)
    assert tool(monkeypatch, "benchmark", "set.yaml", "--out", "theirs", "--workers", "1") == 0
    assert (folder / "mine" / "table.json").read_bytes() == (folder / "theirs" / "table.json").read_bytes()
    part = sr.benchmark("set.yaml", law=["pd"], task=["move"], only=["control_period=0.5"], out="part", workers=1)
    assert part.table.rows == done.table.rows[1:]
    stopped = sr.benchmark("set.yaml", out="stopped", workers=1, hooks=StudyHooks(stop=lambda: "interrupted"))
    assert (stopped.end_reason, stopped.passed) == ("interrupted", False)


def test_a_reproduction_judges_the_claims(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Figures, runs and verdicts are those of the command's claims.json; a stopped one judges nothing."""
    pytest.importorskip("matplotlib")
    done = sr.reproduce(folder / "paper.yaml", "8", out="mine", workers=1)
    (figure,) = done.figures
    assert (done.passed, figure.name) == (True, "8")
    assert [judgement.verdict for judgement in figure.judgements] == ["holds"]
    assert tool(monkeypatch, "reproduce", "paper.yaml", "--out", "theirs", "--workers", "1") == 0
    theirs = json.loads((folder / "theirs" / "claims.json").read_text())
    mine = json.loads(json.dumps(summary(done.plan, done.figures, {})))
    assert theirs["figures"][0]["claims"] == mine["figures"][0]["claims"]
    stopped = sr.reproduce("paper.yaml", out="stopped", workers=1, hooks=StudyHooks(stop=lambda: "terminated"))
    assert (stopped.end_reason, stopped.figures, stopped.passed) == ("terminated", (), False)


REFUSED: list[tuple[Callable[[], object], str]] = [
    (lambda: sr.campaign("small.yaml", workers=0), r"^workers: not a number of workers; got 0"),
    (lambda: sr.campaign("small.yaml", workers=1, scheduler="tcp://x"), r"^scheduler: .*accepted: it or workers"),
    (lambda: sr.campaign("small.yaml", keep="most"), r"^keep: no such choice; got 'most'"),  # type: ignore[arg-type]
    (lambda: sr.campaign("smal.yaml"), r"^campaign: no such campaign file"),
    (lambda: sr.compare(["small.yaml", "small.yaml"]), r"compared twice; got 'small.yaml'"),
    (lambda: sr.compare("small.yaml", workers=-1), r"^workers: not a number of workers; got -1"),
    (lambda: sr.benchmark("set.yaml", workers=0), r"^workers: not a number of workers; got 0"),
    (lambda: sr.benchmark("set.yaml", law=["pdd"]), r"^law: is not in this benchmark; got 'pdd'; accepted: pd"),
    (lambda: sr.benchmark("set.yaml", task=["mov"]), r"^task: is not in this benchmark"),
    (lambda: sr.benchmark("set.yaml", only=["control_period=1"]), r"^only control_period: .*accepted: 0.25, 0.5"),
    (lambda: sr.benchmark("set.yaml", short=True), r"^short: names no short part"),
    (lambda: sr.reproduce("paper.yaml", workers=0), r"^workers: not a number of workers; got 0"),
    (lambda: sr.reproduce("paper.yaml", ["9"]), r"^figures: no such figure; got '9'"),
    (lambda: sr.reproduce("liu2024"), r"^paper: no such manifest .*liu2023"),
]


@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize(("call", "said"), REFUSED)
def test_bad_arguments_are_named_as_typed(call: Callable[[], object], said: str) -> None:
    """One line with the argument, the value and what is accepted; never an option of the command line."""
    with pytest.raises(sr.SpaceRobotError, match=said) as caught:
        call()
    assert "--" not in str(caught.value)


@pytest.mark.parametrize("call", ["campaign('fig08_dispersed')", "compare()"])
def test_without_the_table_library_the_extra_is_named(tmp_path: Path, call: str) -> None:
    """The names are there without pyarrow; calling them says what to install and writes nothing."""
    code = f"import sys; sys.modules['pyarrow'] = None; import space_robot as sr; sr.{call}"
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=tmp_path)
    assert "SpecError: " in done.stderr
    assert "install space-robot[campaign]" in done.stderr
    assert [*tmp_path.iterdir()] == []
