"""Seeded fuzzing of everything that reads files and arguments: no traceback, no hang, a bounded memory.

python -m tests.chaos.fuzz --cases 2000 --seed 1
python -m tests.chaos.fuzz --seed 1 --only 1234        # one case again, with its traceback

Case k of a seed is always the same. Cases run in one process, forked anew for every batch, with a bound on its memory
and on the time of each case; what ends the process is the fault of the case that ran.
"""

from __future__ import annotations

import argparse
import os
import pickle
import resource
import select
import signal
import sys
import traceback
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from time import monotonic, process_time
from typing import Any
from unittest.mock import patch

from space_robot_msgs_py.errors import SpaceRobotError
from tests.chaos.targets import KINDS, Bags, make_bags

BATCH = 100
# Of processor time, so that a busy machine makes no hang; and of any time, for what waits.
CPU_SECONDS, SECONDS = 40.0, 300.0
MEMORY = 1 << 30


class Hang(BaseException):
    """A case took too long; no handler of errors may take it for one."""


@dataclass(frozen=True)
class Failure:
    """A case that did what none may."""

    index: int
    kind: str
    what: str
    detail: str


@dataclass
class Outcome:
    """What came of all cases."""

    cases: Counter[str] = field(default_factory=Counter)
    refused: Counter[str] = field(default_factory=Counter)
    failures: list[Failure] = field(default_factory=list)
    slowest: tuple[float, int] = (0.0, -1)
    peak_kib: int = 0

    def __str__(self) -> str:
        cases = ", ".join(f"{n} {kind} ({self.refused[kind]} refused)" for kind, n in sorted(self.cases.items()))
        kinds = Counter(failure.what for failure in self.failures)
        failures = ", ".join(f"{count} {what}" for what, count in kinds.items()) or "0 tracebacks, 0 hangs"
        slow = f"slowest case {self.slowest[1]}: {self.slowest[0]:.1f} s of CPU"
        memory = f"{self.peak_kib // 1024} MiB more at most"
        return f"{sum(self.cases.values())} cases: {cases}; {failures}; {slow}; {memory}"


def fuzz(cases: Sequence[int], seed: int, folder: Path, kinds: Sequence[str] = tuple(KINDS)) -> Outcome:
    """Run cases of a seed in forked processes.

    Args:
        cases: their numbers.
        seed: of all of them.
        folder: for what they write.
        kinds: which there are; case k is of kind k modulo their number.
    """
    bags, outcome, left = make_bags(folder), Outcome(), list(cases)
    _warm(bags, folder)
    while left:
        done = _batch(left[:BATCH], seed, folder, bags, kinds, outcome)
        left = left[done:]
    return outcome


def run_case(index: int, seed: int, folder: Path, bags: Bags, kinds: Sequence[str]) -> str:
    """Run one case here; returns ``fine`` or ``refused``.

    Raises:
        Exception: what none may raise.
    """
    random = Random(f"{seed}/{index}")
    with TemporaryDirectory(dir=folder) as scratch, _inside(Path(scratch)), _not_served():
        try:
            KINDS[kinds[index % len(kinds)]](random, Path(scratch), bags)
        except SpaceRobotError as error:
            line = str(error)
            assert "\n" not in line, line
            assert len(line) < 20_000, line[:200]
            return "refused"
    return "fine"


def _batch(cases: Sequence[int], seed: int, folder: Path, bags: Bags, kinds: Sequence[str], outcome: Outcome) -> int:
    """Fork, run some cases there, and hear how they went; returns how many are done."""
    reading, writing = os.pipe()
    child = os.fork()
    if not child:
        os.close(reading)
        with suppress(BaseException):
            _in_child(cases, seed, folder, bags, kinds, writing)
        os._exit(0)
    os.close(writing)
    done, ended = 0, False
    with os.fdopen(reading, "rb") as pipe:
        while done < len(cases) and not ended:
            index, kind = cases[done], kinds[cases[done] % len(kinds)]
            ready, _, _ = select.select([pipe], [], [], SECONDS)
            found: Any = None
            if ready:
                with suppress(EOFError, pickle.UnpicklingError):
                    found = pickle.load(pipe)
            if found is None:
                ended = True
                what = "hang" if not ready else "end of the process"
                found = (what, "no traceback: the process was stopped or ended", SECONDS, 0)
            _enter(outcome, index, kind, *found)
            done += 1
    with suppress(ProcessLookupError):
        os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    return done


def _enter(outcome: Outcome, index: int, kind: str, what: str, detail: str, seconds: float, peak: int) -> None:
    outcome.cases[kind] += 1
    outcome.refused[kind] += what == "refused"
    outcome.slowest = max(outcome.slowest, (seconds, index))
    outcome.peak_kib = max(outcome.peak_kib, peak)
    if what not in ("fine", "refused"):
        outcome.failures.append(Failure(index, kind, what, detail))


def _in_child(cases: Sequence[int], seed: int, folder: Path, bags: Bags, kinds: Sequence[str], writing: int) -> None:
    _, hard = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (_address_space() + MEMORY, hard))
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    # Libraries in C++ say what they think of a URDF on their own.
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
    with os.fdopen(writing, "wb") as pipe:
        for index in cases:
            began, detail = process_time(), ""
            try:
                with _limited(CPU_SECONDS):
                    what = run_case(index, seed, folder, bags, kinds)
            except Hang:
                what, detail = "hang", traceback.format_exc()
            except MemoryError:
                what, detail = "out of memory", traceback.format_exc()
            except BaseException:
                what, detail = "traceback", traceback.format_exc()
            peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
            pickle.dump((what, detail[-4000:], process_time() - began, peak), pipe)
            pipe.flush()


def _address_space() -> int:
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    return pages * resource.getpagesize()


@contextmanager
def _limited(seconds: float) -> Iterator[None]:
    def stop(*_: object) -> None:
        raise Hang

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


@contextmanager
def _inside(folder: Path) -> Iterator[None]:
    before = Path.cwd()
    os.chdir(folder)
    try:
        yield
    finally:
        os.chdir(before)


@contextmanager
def _not_served() -> Iterator[None]:
    """What would serve, run or wait until Ctrl-C loads what it needs and ends."""
    with (
        patch("space_robot_report.viewer.serve.serve"),
        patch("space_robot_report.viewer.stage.viser", None),
        patch("space_robot_cli.run_command._run", side_effect=SpaceRobotError("not run here")),
        patch("webbrowser.open"),
    ):
        yield


def _warm(bags: Bags, folder: Path) -> None:
    """Load and compile everything once, before the first fork."""
    for kind in KINDS:
        for index in range(6):
            with suppress(Exception):
                run_case(index, 0, folder, bags, (kind,))


def main(arguments: Sequence[str] | None = None) -> int:
    """Fuzz and say what came of it; 1 if a case did what none may."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", type=int, default=None, help="run this case alone, in this process")
    parser.add_argument("--kind", choices=tuple(KINDS), default=None, help="only cases of this kind")
    given = parser.parse_args(arguments)
    kinds = tuple(KINDS) if given.kind is None else (given.kind,)
    with TemporaryDirectory(prefix="space-robot-fuzz-") as name:
        folder = Path(name)
        if given.only is not None:
            print(run_case(given.only, given.seed, folder, make_bags(folder), kinds))
            return 0
        began = monotonic()
        outcome = fuzz(range(given.cases), given.seed, folder, kinds)
    for failure in outcome.failures:
        print(f"case {failure.index} ({failure.kind}): {failure.what}\n{failure.detail}\n", file=sys.stderr)
    print(f"seed {given.seed}, {outcome}; {monotonic() - began:.0f} s")
    return 1 if outcome.failures else 0


if __name__ == "__main__":
    sys.exit(main())
