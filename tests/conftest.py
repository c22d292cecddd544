"""Fixtures of the tests that fly."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from space_robot_cli.main import main
from tests.support.tool import Tool


@pytest.fixture
def space_robot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Tool:
    """The tool's own entry point in an empty folder; in this process, because importing it takes longer than flying."""

    def call(*arguments: str) -> subprocess.CompletedProcess[str]:
        monkeypatch.chdir(tmp_path)
        monkeypatch.setattr(sys, "argv", ["space-robot", *arguments])
        with pytest.raises(SystemExit) as end:
            main()
        said = capsys.readouterr()
        assert isinstance(end.value.code, int)
        return subprocess.CompletedProcess(arguments, end.value.code, said.out, said.err)

    return call
