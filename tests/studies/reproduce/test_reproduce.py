"""A manifest becomes bags, pictures, verdicts and a page; the same ones whatever runs them."""

from __future__ import annotations

import json
import re
import shlex
from pathlib import Path

import pytest

from space_robot_studies.campaign.cases import make_case
from space_robot_studies.campaign.run_case import run_case
from space_robot_studies.campaign.spec import load_campaign
from space_robot_studies.reproduce.plan import load_plan
from space_robot_studies.reproduce.run import Job, run_job
from tests.support.manifests import MANIFEST, claims, without_times, write
from tests.support.nonempty import nonempty
from tests.support.tool import Tool

pytest.importorskip("matplotlib")
pytest.importorskip("jinja2")


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


@pytest.mark.parametrize(("keep", "left"), [("all", 3), ("failed", 0), ("none", 0)])
def test_bags_are_kept_as_the_option_says(space_robot: Tool, tmp_path: Path, keep: str, left: int) -> None:
    """Keep decides which bags stay; the numbers are the same."""
    write(tmp_path, keep=keep)
    assert space_robot("reproduce", "paper.yaml", "--figure", "8").returncode == 0
    assert len(list((tmp_path / "out" / "paper" / "runs").iterdir())) == left
    assert sum(run["bag"] is not None for run in claims(tmp_path / "out" / "paper")["figures"][0]["runs"]) == left


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
