"""How a reproduction ends before its time, goes on, and what a run of it that fails costs."""

from __future__ import annotations

import json
import os
import shutil
import signal
from pathlib import Path

import pytest

from space_robot_studies.reproduce.run import Job, run_job
from tests.support.follow import DEADLINE, ended
from tests.support.forks import fork_main
from tests.support.manifests import MANIFEST, claims, without_times, write
from tests.support.tool import Tool

pytest.importorskip("matplotlib")
pytest.importorskip("jinja2")

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


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_it_without_a_verdict_and_it_can_be_resumed(
    space_robot: Tool, tmp_path: Path, number: signal.Signals
) -> None:
    """A signal ends workers and parent in one line, judges nothing, leaves no page; --resume does only the rest."""
    runs = {"many": {"experiment": "liu2023/fig08", "set": {"duration": 20.0}, "seeds": {"count": 24}}}
    write(tmp_path, runs=runs, panels=[{"signals": ["base.error"]}], tables=[], claims=[], keep="all")
    command = ["reproduce", "paper.yaml", "--figure", "8"]
    with ended([fork_main("space_robot_cli.main", *command, cwd=tmp_path, session=True)]) as (tool,):
        # A quarter is done when the first line comes.
        tool.await_words("run ", DEADLINE)
        os.killpg(tool.pid, number)
        said = tool.communicate(DEADLINE)[1]
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


def test_a_draw_that_cannot_be_run_is_a_failed_run(tmp_path: Path) -> None:
    """What only one case of a campaign draws is found when it is run: it fails with its reason, and leaves no bag."""
    job = Job("liu2023/fig08", ("plant.payload={mass: 1, inertia: [1, 1, 9]}",), tmp_path / "x", (), (), "all")
    data = run_job(job)
    assert not data.completed
    assert data.end_reason.startswith("cannot be run: link payload")
    assert not (tmp_path / "x").exists()
