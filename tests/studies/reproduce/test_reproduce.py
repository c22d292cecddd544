"""A manifest becomes bags, pictures, verdicts and a page; the same ones whatever runs them."""

from __future__ import annotations

import json
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_description.validation import parse_yaml_text
from space_robot_studies.campaign.cases import make_case
from space_robot_studies.campaign.run_case import run_case
from space_robot_studies.campaign.spec import load_campaign
from space_robot_studies.reproduce.plan import load_plan
from space_robot_studies.reproduce.run import Job, run_job
from tests.support.follow import DEADLINE, Spawn
from tests.support.nonempty import nonempty
from tests.support.tool import Tool, refused

pytest.importorskip("matplotlib")
pytest.importorskip("jinja2")

# Two figures share the run "real"; sensors are noisy, so that seeds matter.
MANIFEST = """
title: "A paper with <tags> & brackets [red]"
citation: "Anon, Tests 1, 2023"
notes: Gains are assumed.
figures:
  8:
    title: Orientation
    runs:
      real: {experiment: liu2023/fig08, set: &short {duration: 6.0, plant.sensors.attitude.noise: 1.0e-5}}
      prior: {experiment: liu2023/fig08, set: {<<: *short, nominal.dispersion.eta: 0.2}, seeds: [1, 2]}
    panels:
      - {signals: [base/roll.value, base/roll.reference], of: [real], label: "roll [deg]"}
      - {signals: [base/roll.error], label: "error [deg]", style: {real: red}, legend: {prior 1: first}}
    tables:
      - {rows: runs, columns: {"error [deg]": {signal: base.error, take: max, after: 5.0}}}
    claims:
      - paper: It arrives.
        measures: {late: {signal: base.error, take: max, after: 5.0, of: [real, prior], reduce: max}}
        holds_if: late < 1
        found: "{late:.2f} deg after 5 s in {n} runs"
        expect: holds
      - paper: Wrong parameters make it diverge.
        measures: {diverged: {metric: diverged, of: prior, reduce: sum}}
        holds_if: diverged >= 1
        found: "{diverged:.0f} of {n} diverge"
        expect: does not hold
        because: Twenty percent are little.
      - paper: It is elegant.
        expect: not checkable
        because: No number is given.
  gain:
    title: A varied gain
    kind: beyond
    runs:
      real: {experiment: liu2023/fig08, set: *short}
      varied: {experiment: liu2023/fig08, set: *short, vary: {controller.gains.lambda: [0.5, 1.5]}}
    charts:
      - {measure: {metric: base/roll.final_error}, x: controller.gains.lambda, of: [varied], y_scale: log}
      - {measure: {metric: base/roll.settling_time, missing: skip, reduce: median}}
    tables:
      - {columns: {"error [deg]": {metric: base/roll.final_error, reduce: median}}}
    timing: {of: [real], repeats: 20}
"""
FAILING = """
import numpy as np
from space_robot_control.laws import Law
from space_robot_msgs_py.errors import ControlError

class Failing(Law):
    def compute(self, state, reference):
        if state.stamp >= 1_000_000_000:
            raise ControlError("had enough")
        return np.zeros(6 + self.n), {}
"""
DEADLY = """
import os
from space_robot_control.laws import Law

class Deadly(Law):
    def compute(self, state, reference):
        os._exit(9)
"""


@pytest.fixture(scope="module", autouse=True)
def compiled() -> None:
    """The plant is compiled before: the first use says so in a line of its own."""
    compose(load_experiment("liu2023/fig08")).plant()


def write(folder: Path, text: str = MANIFEST, **changes: Any) -> None:
    """The manifest, with top-level keys of its first figure changed."""
    data = parse_yaml_text(text, "manifest")
    data["figures"][8].update(changes)
    (folder / "paper.yaml").write_text(json.dumps(data))


def claims(folder: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((folder / "claims.json").read_text())
    return found


def without_times(folder: Path) -> str:
    """claims.json without the only numbers that are of the wall clock."""
    data = claims(folder)
    for figure in data["figures"]:
        figure["timing"] = sorted(figure["timing"])
    return json.dumps(data)


def test_one_and_two_workers_give_the_same_bits(space_robot: Tool, tmp_path: Path) -> None:
    """Bags, pictures and claims do not depend on the number of processes; runs two figures share are done once."""
    write(tmp_path)
    for count in ("1", "2"):
        done = space_robot("reproduce", "paper.yaml", "--workers", count, "--out", count)
        assert done.returncode == 0, done.stdout + done.stderr
    assert without_times(tmp_path / "1") == without_times(tmp_path / "2")
    files = sorted(path.relative_to(tmp_path / "1") for path in (tmp_path / "1").rglob("*.*") if path.is_file())
    assert {".png", ".mcap"} <= {path.suffix for path in files}
    for path in files:
        if path.suffix in (".png", ".mcap", ".yaml"):
            assert (tmp_path / "1" / path).read_bytes() == (tmp_path / "2" / path).read_bytes(), path
    assert len(list((tmp_path / "1" / "runs").iterdir())) == 5


def test_the_command_of_a_run_gives_its_bag(space_robot: Tool, tmp_path: Path) -> None:
    """A command copied from the page does that run alone, to the same bytes."""
    write(tmp_path)
    assert space_robot("reproduce", "paper.yaml", "--figure", "8").returncode == 0
    for run in nonempty(claims(tmp_path / "out" / "paper")["figures"][0]["runs"]):
        words = shlex.split(run["command"])
        assert words[:2] == ["space-robot", "run"]
        # Its own exit code is the verdict of the experiment's bounds, which this manifest shortens.
        assert space_robot(*words[1:], "--out", "alone", "--overwrite").returncode in (0, 1)
        (alone,), (bag,) = (tmp_path / "alone").glob("*.mcap"), (tmp_path / "out/paper" / run["bag"]).glob("*.mcap")
        assert alone.read_bytes() == bag.read_bytes()


def test_the_page_has_everything_and_needs_nothing(space_robot: Tool, tmp_path: Path) -> None:
    """Every figure with its picture, claim, verdict and command is on one page that loads no other file."""
    write(tmp_path)
    (tmp_path / "claims.md").write_text("before\n<!-- claims: how -->\nstale\n<!-- end -->\nafter\n")
    done = space_robot("reproduce", "paper.yaml", "--markdown", "claims.md")
    assert done.returncode == 0
    around = (tmp_path / "claims.md").read_text()
    assert around.startswith("before\n<!-- claims: how -->\n\n| figure |")
    assert around.endswith("\n\n<!-- end -->\nafter\n")
    assert "stale" not in around
    row = "| 8 | Wrong parameters make it diverge. | **does not hold** | 0 of 2 diverge (2 runs, seed 1-2); Twenty"
    assert row in (tmp_path / "claims.md").read_text()
    page = (tmp_path / "out" / "paper" / "index.html").read_text()
    assert page.count('<img src="data:image/png;base64,') == 2
    assert not re.findall(r"""(?:src|href)=["'](?!data:|#)""", page)
    assert "<tags>" not in page
    assert "A paper with &lt;tags&gt; &amp; brackets [red]" in page
    data = claims(tmp_path / "out" / "paper")
    for figure in nonempty(data["figures"]):
        assert f'id="figure-{figure["name"]}"' in page
        for run in nonempty(figure["runs"]):
            assert f"<pre>{run['command']}</pre>" in page
    for claim in nonempty([claim for figure in data["figures"] for claim in figure["claims"]]):
        assert page.count(claim["paper"]) == 2
        assert claim["paper"] in done.stdout
        assert claim["verdict"] in done.stdout
    assert data["versions"]["numpy"] in page
    assert "0 of 2 diverge (2 runs, seed 1-2)" in done.stdout
    assert "brackets [red]" in done.stdout


def test_only_the_chosen_figure_is_run(space_robot: Tool, tmp_path: Path) -> None:
    """--figure leaves the others alone; --json prints claims.json and nothing else."""
    write(tmp_path)
    done = space_robot("reproduce", "paper.yaml", "--figure", "gain", "--json", "--out", "here")
    assert json.loads(done.stdout) == claims(tmp_path / "here")
    assert [figure["name"] for figure in claims(tmp_path / "here")["figures"]] == ["gain"]
    assert len(list((tmp_path / "here" / "runs").iterdir())) == 3
    assert not (tmp_path / "here" / "fig08.png").exists()


def test_a_changed_verdict_exits_1(space_robot: Tool, tmp_path: Path) -> None:
    """What is measured differs from what the manifest documents: the page is written, and the exit code says so."""
    write(tmp_path, MANIFEST.replace("late < 1\n", "late < 0\n"))
    done = space_robot("reproduce", "paper.yaml", "--figure", "8")
    assert done.returncode == 1
    assert "CHANGED: expected 'holds'" in done.stdout
    assert "expected: holds" in (tmp_path / "out" / "paper" / "index.html").read_text()


def test_a_failed_run_has_diverged_and_fails_unless_expected(space_robot: Tool, tmp_path: Path) -> None:
    """A law that gives up counts as diverged; the exit is 1 unless the group may fail; no number of it counts."""
    (tmp_path / "failing.py").write_text(FAILING)
    bad = {"experiment": "liu2023/fig08", "set": {"controller": {"law": "failing.py:Failing"}}, "seeds": [1, 2]}
    claim = {
        "paper": "It diverges.",
        "measures": {
            "diverged": {"metric": "diverged", "of": "bad", "reduce": "sum"},
            "settled": {"metric": "base/roll.settling_time", "of": "bad", "reduce": "count", "missing": "skip"},
        },
        "holds_if": "diverged == 2 and settled == 0",
        "found": "{diverged:.0f} of {n} diverge",
        "expect": "holds",
    }
    for may_fail, code in ((False, 1), (True, 0)):
        runs = {"bad": bad | {"may_fail": may_fail}}
        panels = [{"signals": ["base.error"]}]
        write(tmp_path, runs=runs, claims=[claim], panels=panels, tables=[], keep="failed")
        done = space_robot("reproduce", "paper.yaml", "--figure", "8")
        assert done.returncode == code, done.stdout
        assert "holds: 2 of 2 diverge" in done.stdout
        assert ("failed: bad 1: controller: Failing: u: had enough at t = 1 s" in done.stdout) != may_fail
    assert len(list((tmp_path / "out" / "paper" / "runs").iterdir())) == 2


@pytest.mark.parametrize(("keep", "left"), [("all", 3), ("failed", 0), ("none", 0)])
def test_bags_are_kept_as_the_option_says(space_robot: Tool, tmp_path: Path, keep: str, left: int) -> None:
    """Keep decides which bags stay; the numbers are the same."""
    write(tmp_path, keep=keep)
    assert space_robot("reproduce", "paper.yaml", "--figure", "8").returncode == 0
    assert len(list((tmp_path / "out" / "paper" / "runs").iterdir())) == left
    assert sum(run["bag"] is not None for run in claims(tmp_path / "out" / "paper")["figures"][0]["runs"]) == left


ONE = {"metric": "base/roll.final_error", "of": "real"}
CLAIM: dict[str, Any] = {
    "paper": "p",
    "measures": {"a": ONE},
    "holds_if": "a < 1",
    "found": "{a}",
    "expect": "holds",
}
BAD: dict[str, tuple[dict[str, Any], tuple[str, ...]]] = {
    "an unknown key": ({"pannels": []}, ("figures.8.pannels", "panels")),
    "an unknown group": ({"panels": [{"signals": ["base.error"], "of": ["reel"]}]}, ("panels.0.of", "reel", "real")),
    "an unknown signal": ({"panels": [{"signals": ["base/rol.error"]}]}, ("panels.0.signals.0", "base/roll.error")),
    "an unknown color": (
        {"panels": [{"signals": ["base.error"], "style": {"real": "rde"}}]},
        ("panels.0.style.real", "rde"),
    ),
    "style of nothing": (
        {"panels": [{"signals": ["base.error"], "style": {"reel": "red"}}]},
        ("panels.0.style", "reel", "real"),
    ),
    "empty limits": ({"panels": [{"signals": ["base.error"], "limits": [1, 1]}]}, ("panels.0.limits",)),
    "no place on a log scale": (
        {"panels": [{"signals": ["base.error"], "limits": [0, 1], "y_scale": "log"}]},
        ("panels.0.limits", "above 0"),
    ),
    "a window the wrong way": (
        {"panels": [{"signals": ["base.error"], "after": 3, "before": 2}]},
        ("panels.0.before", "> 3"),
    ),
    "an unknown metric": (
        {"tables": [{"columns": {"x": {"metric": "base/roll.setling_time", "reduce": "max"}}}]},
        ("tables.0.columns.x.metric", "base/roll.settling_time"),
    ),
    "many runs and no reduce": (
        {"tables": [{"columns": {"x": {"metric": "base/roll.max_error"}}}]},
        ("tables.0.columns.x", "2 runs and no reduce"),
    ),
    "an unknown abscissa": (
        {"charts": [{"measure": {"metric": "completed"}, "x": "controller.gains.lambd"}]},
        ("charts.0.x", "controller.gains.lambd"),
    ),
    "a take without a signal": (
        {"claims": [CLAIM | {"measures": {"a": {"metric": "completed", "take": "max", "of": "real"}}}]},
        ("claims.0.measures.a", "signal and take"),
    ),
    "a window behind the end": (
        {"claims": [CLAIM | {"measures": {"a": {"signal": "base.error", "take": "max", "after": 7, "of": "real"}}}]},
        ("claims.0.measures.a.after", "6 s"),
    ),
    "where nothing is": ({"claims": [CLAIM | {"measures": {"a": ONE | {"where": {"seed": 9}}}}]}, ("a.where", "9")),
    "a time of nothing": (
        {"claims": [CLAIM | {"measures": {"a": {"timing": "mean", "of": "real"}}}]},
        ("claims.0.measures.a.timing", "timing table"),
    ),
    "a name that is a word": ({"claims": [CLAIM | {"measures": {"lambda": ONE}}]}, ("claims.0.measures", "lambda")),
    "a name that is none": ({"claims": [CLAIM | {"measures": {"a b": ONE}}]}, ("claims.0.measures", "a b")),
    "a condition of unknowns": ({"claims": [CLAIM | {"holds_if": "b < 1"}]}, ("claims.0.holds_if", "'b'")),
    "a text of unknowns": ({"claims": [CLAIM | {"found": "{b}"}]}, ("claims.0.found", "'b'")),
    "an unknown verdict": ({"claims": [CLAIM | {"expect": "hold"}]}, ("claims.0.expect", "holds")),
    "no reason": ({"claims": [{"paper": "p", "expect": "not checkable"}]}, ("claims.0", "because")),
    "a run that cannot be composed": (
        {"runs": {"real": {"experiment": "liu2023/fig08", "set": {"controller.gains.lambda": -1}}}},
        ("figures.8.runs.real", "real cannot be run", "lambda"),
    ),
    "two runs of one label": (
        {"runs": {"a": {"experiment": "liu2023/fig08", "seeds": [1, 2]}, "a 1": {"experiment": "liu2023/fig08"}}},
        ("figures.8.runs", "a 1"),
    ),
    "a timed crowd": ({"timing": {"of": ["prior"]}}, ("timing.of", "more than one run")),
}


@pytest.mark.parametrize(("changes", "words"), list(BAD.values()), ids=list(BAD))
def test_a_bad_manifest_gets_one_line_and_leaves_nothing(
    space_robot: Tool, tmp_path: Path, changes: dict[str, Any], words: tuple[str, ...]
) -> None:
    """Every mistake is found before the first run: key path, value and what would do, exit 2, nothing written."""
    emptied: dict[str, Any] = {"panels": [], "tables": [], "claims": []}
    write(tmp_path, **(emptied | changes))
    before = set(tmp_path.rglob("*"))
    refused(space_robot("reproduce", "paper.yaml", "--figure", "8"), *words)
    assert set(tmp_path.rglob("*")) == before


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("papr.yaml",), ("paper", "papr.yaml")),
        (("paper.yaml", "--figure", "gian"), ("--figure", "gian", "gain")),
        (("paper.yaml", "--workers", "0"), ("--workers", "0")),
        (("paper.yaml", "--time-limit", "-1"), ("--time-limit", "-1")),
        (("paper.yaml", "--out", "precious"), ("--out", "precious")),
        (("paper.yaml", "--out", "paper.yaml"), ("--out", "paper.yaml")),
        (("paper.yaml", "--markdown", "no/where.md"), ("--markdown", "no/where.md")),
    ],
)
def test_bad_options_get_one_line_and_leave_nothing(
    space_robot: Tool, tmp_path: Path, arguments: tuple[str, ...], words: tuple[str, ...]
) -> None:
    """Unknown papers and figures suggest the nearest; a folder of something else is not touched."""
    write(tmp_path)
    (tmp_path / "precious").mkdir()
    (tmp_path / "precious" / "index.html").write_text("years")
    before = set(tmp_path.rglob("*"))
    refused(space_robot("reproduce", *arguments), *words)
    assert set(tmp_path.rglob("*")) == before


def test_without_the_drawing_libraries_it_says_what_to_install(
    space_robot: Tool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without matplotlib or jinja2 nothing is run and the extra is named."""
    write(tmp_path)
    monkeypatch.setitem(sys.modules, "jinja2", None)
    for name in ("html", "paper_report"):
        monkeypatch.delitem(sys.modules, f"space_robot_report.pages.{name}", raising=False)
    refused(space_robot("reproduce", "paper.yaml"), "jinja2", "space-robot[viz]")
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_it_without_a_verdict_and_it_can_be_resumed(
    space_robot: Tool, tmp_path: Path, spawn: Spawn, number: signal.Signals
) -> None:
    """A signal ends workers and parent in one line, judges nothing, leaves no page; --resume does only the rest."""
    runs = {"many": {"experiment": "liu2023/fig08", "set": {"duration": 20.0}, "seeds": {"count": 24}}}
    write(tmp_path, runs=runs, panels=[{"signals": ["base.error"]}], tables=[], claims=[], keep="all")
    command = [sys.executable, "-m", "space_robot_cli", "reproduce", "paper.yaml", "--figure", "8"]
    tool = spawn(command, cwd=tmp_path, stderr=subprocess.PIPE, start_new_session=True)
    assert tool.stderr is not None
    # A quarter is done when the first line comes.
    assert tool.stderr.readline().startswith("run ")
    os.killpg(tool.pid, number)
    said = tool.communicate(timeout=DEADLINE)[1]
    assert tool.returncode == 1, said
    word = "interrupted" if number == signal.SIGINT else "terminated"
    assert f"{word}: finished runs are kept; go on with --resume" in said
    assert "Traceback" not in said
    place = tmp_path / "out" / "paper"
    assert not (place / "index.html").exists()
    rows = (place / "rows.jsonl").read_text().splitlines()[1:]
    assert 6 <= len(rows) < 24
    assert space_robot("reproduce", "paper.yaml", "--figure", "8", "--resume").returncode == 0
    assert (place / "rows.jsonl").read_text().splitlines()[1 : 1 + len(rows)] == rows
    assert len((place / "rows.jsonl").read_text().splitlines()) == 25


def test_a_resumed_reproduction_equals_an_uninterrupted_one(space_robot: Tool, tmp_path: Path) -> None:
    """Page and claims of a resumed reproduction are those of one at a stretch; what has changed is run again."""
    write(tmp_path)
    assert space_robot("reproduce", "paper.yaml").returncode == 0
    place = tmp_path / "out" / "paper"
    before, pictures = without_times(place), [(place / name).read_bytes() for name in ("fig08.png", "gain.png")]
    lines = (place / "rows.jsonl").read_text().splitlines()
    # A torn line, a run whose bag is gone, and one that has not been done.
    names = [json.loads(line)["key"] for line in lines[1:]]
    shutil.rmtree(place / "runs" / names[0])
    (place / "rows.jsonl").write_text("\n".join(lines[:-1]) + "\n" + lines[-1][:50])
    assert space_robot("reproduce", "paper.yaml", "--resume").returncode == 0
    assert without_times(place) == before
    assert [(place / name).read_bytes() for name in ("fig08.png", "gain.png")] == pictures
    again = [json.loads(line)["key"] for line in (place / "rows.jsonl").read_text().splitlines()[len(lines) - 1 :]]
    assert sorted(again) == sorted([names[0], names[-1]])
    write(tmp_path, MANIFEST.replace("nominal.dispersion.eta: 0.2", "nominal.dispersion.eta: 0.1"))
    rows = len((place / "rows.jsonl").read_text().splitlines())
    assert space_robot("reproduce", "paper.yaml", "--resume").returncode == 0
    assert len((place / "rows.jsonl").read_text().splitlines()) == rows + 2


def test_a_run_that_is_lost_is_never_expected(space_robot: Tool, tmp_path: Path) -> None:
    """A law that kills its worker fails the reproduction, also where a group may fail; the other runs are there."""
    (tmp_path / "deadly.py").write_text(DEADLY)
    bad = {"experiment": "liu2023/fig08", "set": {"controller": {"law": "deadly.py:Deadly"}}, "may_fail": True}
    fine = {"experiment": "liu2023/fig08", "set": {"duration": 2.0}}
    write(tmp_path, runs={"bad": bad, "fine": fine}, claims=[], panels=[], tables=[], keep="none")
    done = space_robot("reproduce", "paper.yaml", "--figure", "8")
    assert done.returncode == 1
    assert "failed: bad: lost: the worker process exited with status 9" in done.stdout
    assert [run["completed"] for run in claims(tmp_path / "out" / "paper")["figures"][0]["runs"]] == [False, True]


def test_a_campaigns_directory_is_left_alone(space_robot: Tool, tmp_path: Path) -> None:
    """A reproduction goes into no directory of a campaign, whose rows it would replace."""
    write(tmp_path)
    (tmp_path / "mc" / "runs").mkdir(parents=True)
    for name in ("resolved.yaml", "rows.jsonl"):
        (tmp_path / "mc" / name).write_text("years")
    refused(space_robot("reproduce", "paper.yaml", "--out", "mc"), "--out", "holds a campaign")
    assert (tmp_path / "mc" / "rows.jsonl").read_text() == "years"


def test_a_reproduced_case_equals_the_case_of_its_campaign(tmp_path: Path) -> None:
    """Every number of a case is the same whether the campaign runs it or the manifest shows it."""
    manifest = {"8": {"title": "t", "runs": {"x": {"campaign": "giordano2023/sec5_euler", "runs": 2}}}}
    (tmp_path / "paper.yaml").write_text(json.dumps({"title": "t", "citation": "c", "figures": manifest}))
    campaign = load_campaign("giordano2023/sec5_euler")
    for run in nonempty(load_plan(str(tmp_path / "paper.yaml")).runs["8"]["x"]):
        overrides = (*run.distinct.overrides, "duration=3.0")
        shown = run_job(Job(run.distinct.argument, overrides, tmp_path / run.distinct.name, (), (), "none"))
        data = dict(make_case(campaign, run.values["run"]).data) | {"duration": 3.0}
        columns = run_case(data, "case", "none").columns
        assert shown.completed
        assert len(shown.metrics) > 50
        assert shown.metrics == {name: columns[name] for name in shown.metrics}


def test_a_draw_that_cannot_be_run_is_a_failed_run(tmp_path: Path) -> None:
    """What only one case of a campaign draws is found when it is run: it fails with its reason, and leaves no bag."""
    job = Job("liu2023/fig08", ("plant.payload={mass: 1, inertia: [1, 1, 9]}",), tmp_path / "x", (), (), "all")
    data = run_job(job)
    assert not data.completed
    assert data.end_reason.startswith("cannot be run: link payload")
    assert not (tmp_path / "x").exists()
