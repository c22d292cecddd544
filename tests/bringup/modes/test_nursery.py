"""A forked process is what a started one would be: it is followed, signalled and judged as one."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path
from threading import Event
from typing import Any

import pytest

from space_robot_bringup.modes.forked import NOT_KNOWN, ForkedProcess
from space_robot_bringup.modes.nursery import Nursery, nursery
from space_robot_msgs_py.errors import SilenceError

PRELOADED = "json.tool"


def end_with(code: Any) -> Any:
    if code == "error":
        raise ValueError("no code")
    if code == "exit":
        sys.exit(3)
    return code


def stay() -> None:
    Event().wait()


def tell(descriptor: int) -> None:
    listed = sorted(map(int, os.listdir("/proc/self/fd")))
    loaded = PRELOADED in sys.modules
    # Without that of the listing, which is closed by now.
    held = [number for number in listed if Path(f"/proc/self/fd/{number}").exists()]
    os.write(descriptor, repr((held, os.getcwd(), os.environ.get("OF_ITS_OWN"), loaded)).encode())
    os.write(1, b"printed")


def forked(function: Any, *arguments: Any, **options: Any) -> ForkedProcess:
    return nursery(PRELOADED).fork(f"{__name__}:{function.__name__}", *arguments, **options)


@pytest.mark.parametrize(("given", "code"), [(None, 0), (0, 0), (5, 5), ("exit", 3), ("error", 1)])
def test_the_code_is_that_of_the_function(given: Any, code: int) -> None:
    """What it returns, 0 for nothing; that of ``sys.exit``, and 1 where it raised."""
    process = forked(end_with, given)
    assert process.wait(60.0) == code
    assert (process.poll(), process.returncode) == (code, code)


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGUSR1])
def test_the_code_of_a_signal_is_its_number(number: signal.Signals) -> None:
    """It runs until it is ended, waits end in time, and a signal that comes too late reaches no other process."""
    process = forked(stay)
    assert process.poll() is None
    with pytest.raises(subprocess.TimeoutExpired):
        process.wait(0.01)
    process.send_signal(number)
    assert process.wait(60.0) == -number
    process.kill()
    assert process.returncode == -number


def test_it_holds_what_it_was_given_and_nothing_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """Its descriptors have their numbers, its folder and environment are of now, and it prints on stderr."""
    monkeypatch.chdir(tmp_path)
    ours, theirs = os.pipe()
    process = forked(tell, theirs, descriptors=[theirs], environment=os.environ | {"OF_ITS_OWN": "yes"})
    os.close(theirs)
    assert process.wait(60.0) == 0
    with open(ours, "rb") as pipe:
        # Read to its end: neither the nursery nor what it forks next holds the other one.
        assert pipe.read().decode() == repr(([0, 1, 2, theirs], str(tmp_path), "yes", True))
    said = capfd.readouterr()
    assert (said.out, said.err) == ("", "printed")


def test_a_process_outlives_its_nursery() -> None:
    """It goes on, it can be ended, and then it is known that it has, if not how; nothing new is forked."""
    source = Nursery(PRELOADED)
    process = source.fork(f"{__name__}:{stay.__name__}")
    os.kill(source.pid, signal.SIGKILL)
    source.wait()
    assert process.poll() is None
    process.kill()
    assert process.wait(60.0) == NOT_KNOWN
    with pytest.raises(SilenceError, match="no process can be started"):
        source.fork(f"{__name__}:{stay.__name__}")
    source.close()
