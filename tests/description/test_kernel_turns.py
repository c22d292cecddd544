"""Processes that start together compile a kernel once among them."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from space_robot_description.kernel import jit
from tests.support.follow import DEADLINE, ended
from tests.support.paths import ROOT

pytestmark = pytest.mark.skipif(not jit.COMPILED, reason="numba is not installed")

MADE = """
from space_robot_description.kernel.jit import kernel

@kernel
def call(x):
    return 2.0 * x
"""
TYPED = """
from typing import NamedTuple
from space_robot_description.kernel.jit import kernel

class {name}(NamedTuple):
    x: float

@kernel
def call(of):
    return 2.0 * of.x
"""
CALL = """
import sys
from made import call
print("ready", flush=True)
sys.stdin.readline()
print(call(1.5), sum(call.stats.cache_misses.values()))
"""
# Its turn begins and does not end.
STOP = """
import sys, time
from made import call
call._cache.save_overload = lambda *_: (print("compiled", flush=True), time.sleep(1000))
call(1.5)
"""


def python(folder: Path, text: str) -> subprocess.Popen[str]:
    """A process that finds the module ``made``, with an empty cache of its own in the folder."""
    environment = os.environ | {"PYTHONPATH": str(folder), "NUMBA_CACHE_DIR": str(folder / "cache")}
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    return subprocess.Popen([sys.executable, "-c", text], env=environment, cwd=ROOT, text=True, **pipes)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """With a module of one kernel."""
    (tmp_path / "made.py").write_text(MADE)
    return tmp_path


def test_a_kernel_is_compiled_by_one_of_the_processes_that_need_it(folder: Path) -> None:
    """Of three processes that call it at once with an empty cache one compiles it, and all get its result."""
    with ended([python(folder, CALL) for _ in range(3)]) as processes:
        for process in processes:
            assert process.stdout is not None
            assert process.stdout.readline() == "ready\n"
            assert process.stdin is not None
            process.stdin.write("go\n")
        for process in processes:
            assert process.stdin is not None
            process.stdin.flush()
        said = [process.communicate(timeout=DEADLINE) for process in processes]
    assert sorted(out.split() for out, _ in said) == [["3.0", "0"], ["3.0", "0"], ["3.0", "1"]], said


def test_a_class_that_was_renamed_makes_a_cache_old_and_not_unusable(folder: Path) -> None:
    """After an update of the sources, a kernel of a type that has another name now is compiled again."""
    said = []
    for name in ("Before", "Before", "After"):
        (folder / "made.py").write_text(TYPED.format(name=name))
        with ended(
            [python(folder, CALL.replace("call(1.5)", f"call({name}(1.5))", 1).replace("call\n", "*\n", 1))]
        ) as (process,):
            said.append(process.communicate("go\n", timeout=DEADLINE))
    assert [out.split()[1:] for out, _ in said] == [["3.0", "1"], ["3.0", "0"], ["3.0", "1"]], said


def test_the_turn_of_a_killed_process_goes_to_the_next(folder: Path) -> None:
    """A process that is killed while it compiles leaves no other waiting."""
    with ended([python(folder, STOP)]) as (stopped,):
        assert stopped.stdout is not None
        assert stopped.stdout.readline() == "compiled\n"
        with ended([python(folder, CALL)]) as (other,):
            assert other.stdin is not None
            other.stdin.write("go\n")
            other.stdin.flush()
            assert other.stdout is not None
            assert other.stdout.readline() == "ready\n"
            stopped.send_signal(signal.SIGKILL)
            out, error = other.communicate(timeout=DEADLINE)
    assert out.split() == ["3.0", "1"], error
