"""How the command line says that something ended before its time: one line, exit 1."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Never

import pytest

from space_robot_cli import main
from space_robot_cli.system_libraries import missing_library
from space_robot_msgs_py.atomic_file import write_atomically
from space_robot_msgs_py.log.run_directory import RunDirectory
from tests.support.paths import ROOT
from tests.support.tool import Tool, refused

FIG08 = ("run", "liu2023/fig08", "--duration", "5", "--out", "run")


def law(name: str) -> tuple[str, str]:
    return "--set", f"controller.law=tests.support.laws:{name}"


def test_an_exception_of_a_law_is_one_line_and_exit_1(space_robot: Tool) -> None:
    """A law that raises costs one line with law, tick and cause, and exit 1; the traceback comes with --debug."""
    done = space_robot(*FIG08, *law("Buggy"))
    assert (done.returncode, done.stderr) == (1, "")
    assert "FAIL (controller: law buggy at tick 0: KeyError: 'a typo')" in done.stdout
    assert "tick 0 at 0 s has no command of the law tests.support.laws:Buggy" in done.stdout
    shown = space_robot(*FIG08, *law("Buggy"), "--debug", "--overwrite")
    assert "Traceback" in shown.stderr
    assert 'raise KeyError("a typo")' in shown.stderr


def test_a_law_that_hangs_is_ended(space_robot: Tool, monkeypatch: pytest.MonkeyPatch) -> None:
    """--timeout ends a law that computes for ever: exit 1, the tick, and ``timeout`` as the reason."""
    monkeypatch.setattr("space_robot_bringup.modes.signals.GRACE_SECONDS", 0.2)
    done = space_robot(*FIG08, *law("Endless"), "--timeout", "3")
    assert done.returncode == 1
    assert "FAIL (timeout)" in done.stdout
    assert "tick 2 at 0.5 s has no command" in done.stdout


@pytest.mark.parametrize("limit", ["0", "-1", "nan", "inf"])
def test_a_limit_is_a_positive_number(space_robot: Tool, limit: str) -> None:
    """Anything else is refused by name."""
    refused(space_robot(*FIG08, "--timeout", limit), "--timeout", "a positive number")


def test_a_directory_in_use_is_refused(space_robot: Tool, tmp_path: Path) -> None:
    """A second run into one directory is bad input: exit 2, one line, nothing touched."""
    with RunDirectory(tmp_path / "run"):
        refused(space_robot(*FIG08, "--json"), "run", "another run is writing here")


@pytest.mark.parametrize(("number", "word"), [(signal.SIGTERM, "terminated"), (signal.SIGINT, "interrupted")])
def test_a_signal_ends_any_command_with_one_line(
    space_robot: Tool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, number: signal.Signals, word: str
) -> None:
    """SIGTERM and Ctrl-C to a report that is being written: one line, exit 1, and nothing half written."""
    assert "(completed)" in space_robot(*FIG08).stdout
    monkeypatch.setattr("space_robot_msgs_py.atomic_file.os.fsync", lambda descriptor: os.kill(os.getpid(), number))
    done = space_robot("report", "run")
    assert (done.returncode, done.stdout, done.stderr) == (1, "", f"space-robot: {word}\n")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["run"]


def test_a_file_is_whole_or_not_there_whatever_ends_the_writing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An interruption leaves the old file and nothing beside it."""
    write_atomically(tmp_path / "page", "old")

    def interrupt(descriptor: int) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("space_robot_msgs_py.atomic_file.os.fsync", interrupt)
    with pytest.raises(KeyboardInterrupt):
        write_atomically(tmp_path / "page", "new")
    assert [(path.name, path.read_text()) for path in tmp_path.iterdir()] == [("page", "old")]


def test_ctrl_c_before_the_run_begins_ends_it(tmp_path: Path) -> None:
    """Ctrl-C while a law is being made, which compiling is a part of: one line, exit 1, no directory left."""
    command = [sys.executable, "-m", "space_robot_cli", *FIG08[:-1], str(tmp_path / "run"), *law("NeverMade")]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdout=pipe, stderr=pipe, text=True, cwd=ROOT) as run:
        assert run.stdout is not None
        assert run.stdout.readline() == "making\n"
        run.send_signal(signal.SIGINT)
        out, err = run.communicate(timeout=60)
    assert (run.returncode, out, err) == (1, "", "space-robot: interrupted\n")
    assert not (tmp_path / "run").exists()


def test_a_missing_library_of_the_system_is_one_line_and_exit_2(
    space_robot: Tool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A container of the least kind lacks what the wheel of Pinocchio needs: what is missing, and how to install it."""

    def loaded(_: str) -> Never:
        raise ImportError("libgomp.so.1: cannot open shared object file: No such file or directory")

    monkeypatch.setattr(main, "load_commands", loaded)
    refused(space_robot("list"), "libgomp.so.1", "apt install libgomp1")


def test_another_error_of_an_import_is_not_taken_for_it() -> None:
    """Only the dynamic loader's words are meant."""
    assert missing_library(ImportError("cannot import name 'x' from 'y'")) is None
