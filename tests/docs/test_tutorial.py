"""The tutorial is followed step by step as it stands on its page: files, commands, exit codes, what they say."""

from __future__ import annotations

import re
import shlex
import sys
from pathlib import Path

import pyarrow.parquet as pq
import pytest

import space_robot
from space_robot_cli.main import main
from tests.support.paths import ROOT

PAGE = (ROOT / "docs" / "tutorial-faults.md").read_text(encoding="utf-8")
pytestmark = pytest.mark.xdist_group("campaign")


def blocks(language: str) -> list[str]:
    """The fenced blocks of a language."""
    return re.findall(rf"```{language}\n(.*?)```", PAGE, re.DOTALL)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where the files of the page lie under the names in their first lines."""
    for text in (*blocks("yaml"), *blocks("python")):
        name = text.splitlines()[0].removeprefix("# ")
        (tmp_path / name).write_text(text, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def exit_code(line: str, monkeypatch: pytest.MonkeyPatch) -> int:
    """Of a command line, in this process."""
    monkeypatch.setattr(sys, "argv", shlex.split(line, comments=True))
    with pytest.raises(SystemExit) as end:
        main()
    return int(str(end.value.code))


def test_the_commands_of_the_tutorial_work_in_their_order(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Each ends as the page says; every line of the story, and every number of the campaign, is what comes out."""
    pytest.importorskip("plotly")
    lines = [line for text in blocks("sh") for line in text.splitlines() if line.startswith("space-robot")]
    said = {}
    for line in (line for line in lines if "--mode graph" not in line):
        assert exit_code(line, monkeypatch) == ("exits with 1" in line), line
        said[line.split()[1] + line.split()[2]] = capsys.readouterr().out
    assert "completed, nothing was expected" in said["runwheel.yaml"]
    assert re.search(r"base/yaw \[deg\] +\S+ +\S+ +31\.8 ", said["runwheel.yaml"])
    story = blocks("")[0].splitlines()
    printed = {" ".join(line.split()) for line in said["eventsruns/watched"].splitlines()}
    assert [line for line in story if " ".join(line.split()) not in printed] == []
    rows = pq.read_table(folder / "runs/onset/table.parquet").to_pylist()
    failed = [row for row in rows if not row["passed"]]
    assert (len(rows), len(failed), {row["failed"] for row in failed}) == (20, 5, {"mode.SAFE"})
    assert all(31.0 <= row["faults.0.at"] <= 33.2 for row in failed)


def test_the_test_of_the_tutorial_passes(folder: Path) -> None:
    """As a test framework would run it."""
    (text,) = blocks("python")
    names: dict[str, object] = {}
    exec(compile(text, "test_wheel.py", "exec"), names)
    test = names["test_a_seized_wheel_costs_no_robot"]
    assert callable(test)
    test()


def test_the_campaign_would_pass_with_the_time_that_the_page_names(folder: Path) -> None:
    """The worst onset needs 15.5 s."""
    run = space_robot.run("watched.yaml", {"faults.0.at": 31.0})
    (mode,) = [check for check in run.verdict if check.requirement == "REQ-1"]
    assert not mode.passed
    (mode,) = run.expect({"mode": {"SAFE": {"within": 16.0, "after": "wheel"}}})
    assert mode.measured == pytest.approx(15.5)
