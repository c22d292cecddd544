"""``python -m benchmarks.older COMMIT`` runs graph and processes of another commit and of this tree, taking turns.

The other commit is checked out into a folder of its own and runs with the packages of this environment. Both sides run
the same command twice, once longer: the difference is without start and end. CPU time is that of all processes.
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from itertools import product
from pathlib import Path
from time import perf_counter

HERE = Path(__file__).resolve().parents[1]
CASE, PERIOD = "liu2023/fig08", 0.1
SHORT, LONG = 200, 5200
MODES = ("graph", "processes")


def main() -> int:
    """Print, for each mode, CPU and wall time per tick of both sides, and their ratios."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.older", description=__doc__)
    parser.add_argument("commit", help="of this repository")
    parser.add_argument("--repeats", type=int, default=5, help="turns; default: 5")
    options = parser.parse_args()
    sides, found = (options.commit, "this tree"), dict[tuple[str, str, int], list[tuple[float, float]]]()
    with checked_out(options.commit) as there:
        trees = dict(zip(sides, (there, HERE), strict=True))
        for tree in trees.values():
            # What is compiled is then there.
            _run(tree, "graph", 2)
        for turn in product(range(options.repeats), MODES, sides, (SHORT, LONG)):
            found.setdefault(turn[1:], []).append(_run(trees[turn[2]], turn[1], turn[3]))
            print(*turn, *found[turn[1:]][-1], file=sys.stderr, flush=True)
    for mode in MODES:
        for index, clock in enumerate(("CPU", "wall")):
            old, new = (per_tick(*(found[mode, side, ticks] for ticks in (SHORT, LONG)), index) for side in sides)
            both = f"{1e6 * old:.1f} and now {1e6 * new:.1f} us per tick"
            print(f"{mode}, {clock}: {both}, {old / new:.2f} times as fast")
    return 0


def per_tick(short: Sequence[tuple[float, float]], long: Sequence[tuple[float, float]], clock: int) -> float:
    """Time of a tick [s] by runs of both lengths: the least of each, CPU (0) or wall (1)."""
    least, most = (min(one[clock] for one in runs) for runs in (short, long))
    return (most - least) / (LONG - SHORT)


@contextmanager
def checked_out(commit: str) -> Iterator[Path]:
    """A folder with the files of a commit, for as long as it is needed."""
    with tempfile.TemporaryDirectory() as scratch:
        there = Path(scratch) / "tree"
        subprocess.run(["git", "worktree", "add", "--detach", str(there), commit], cwd=HERE, check=True)
        try:
            yield there
        finally:
            subprocess.run(["git", "worktree", "remove", "--force", str(there)], cwd=HERE, check=True)


def _run(tree: Path, mode: str, ticks: int) -> tuple[float, float]:
    """CPU time of all processes of a run from a folder, and wall time [s]."""
    with tempfile.TemporaryDirectory() as scratch:
        command = [sys.executable, "-c", _entry(tree), "run", CASE, "--mode", mode, "--out", str(Path(scratch) / "run")]
        command += ["--set", f"control_period={PERIOD}", "--set", "expect={}"]
        command += ["--duration", repr(ticks * PERIOD)]
        # The folder first: an installed tree may be another one.
        environment = os.environ | {"PYTHONPATH": str(tree), "NUMBA_CACHE_DIR": str(tree / ".numba")}
        before, begun = resource.getrusage(resource.RUSAGE_CHILDREN), perf_counter()
        subprocess.run(command, cwd=tree, env=environment, stdout=subprocess.DEVNULL)
        after, ended = resource.getrusage(resource.RUSAGE_CHILDREN), perf_counter()
    spent = (after.ru_utime + after.ru_stime) - (before.ru_utime + before.ru_stime)
    return spent, ended - begun


def _entry(tree: Path) -> str:
    """The command of a folder as a text of Python."""
    scripts = tomllib.loads((tree / "pyproject.toml").read_text(encoding="utf-8"))["project"]["scripts"]
    module, name = scripts["space-robot"].split(":")
    return f"import sys; from {module} import {name}; sys.exit({name}())"


if __name__ == "__main__":
    raise SystemExit(main())
