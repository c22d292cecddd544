"""The tutorial in six steps is followed as it stands on its page."""

from __future__ import annotations

import re
import shlex
import sys
from pathlib import Path

import pytest

from space_robot_cli.main import main
from tests.support.paths import ROOT

PAGE = (ROOT / "docs" / "tutorial.md").read_text(encoding="utf-8")


@pytest.mark.xdist_group("campaign")
def test_the_six_steps_work_in_their_order(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Each command ends as the page says; what the page says of them is what they print."""
    pytest.importorskip("plotly")
    assert [int(number) for number in re.findall(r"^## (\d)\.", PAGE, re.MULTILINE)] == [1, 2, 3, 4, 5, 6]
    monkeypatch.chdir(tmp_path)
    said: dict[str, str] = {}
    for line in re.findall(r"^space-robot .*$", PAGE, re.MULTILINE):
        monkeypatch.setattr(sys, "argv", shlex.split(line, comments=True))
        with pytest.raises(SystemExit) as end:
            main()
        printed = capsys.readouterr()
        assert end.value.code == ("exits with 1" in line), (line, printed)
        said[line.partition("#")[0].strip()] = printed.out + printed.err
    outputs = list(said.values())
    assert "PASS" in outputs[0]
    (events,) = (text for line, text in said.items() if " events " in line)
    assert re.search(r"jet begins", events)
    assert re.search(r"SAFE", events)
    equal, changed = (text for line, text in said.items() if " replay " in line)
    assert "EQUAL" in equal
    assert "DIFFERENT" not in equal
    assert "DIFFERENT" in changed
    for name in ("first.html", "study.html"):
        assert (tmp_path / "runs" / name).is_file()
