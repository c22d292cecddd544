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
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from time import perf_counter

HERE = Path(__file__).resolve().parents[1]
CASE, PERIOD = "liu2023/fig08", 0.1
SHORT, LONG = 500, 4500
MODES = ("graph", "processes")


def main() -> int:
    """Print, for each mode, CPU and wall time per tick of both sides, the least of the turns, and their ratios."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.older", description=__doc__)
    parser.add_argument("commit", help="of this repository")
    parser.add_argument("--repeats", type=int, default=5, help="turns; default: 5")
    options = parser.parse_args()
    found: dict[tuple[str, str], list[tuple[float, float]]] = {}
    with checked_out(options.commit) as there:
        for _ in range(options.repeats):
            for mode in MODES:
                for side, tree in ((options.commit, there), ("this tree", HERE)):
                    found.setdefault((mode, side), []).append(per_tick(tree, mode))
    for mode in MODES:
        for index, clock in enumerate(("CPU", "wall")):
            old, new = (min(one[index] for one in found[mode, side]) for side in (options.commit, "this tree"))
            both = f"{1e6 * old:.1f} and now {1e6 * new:.1f} us per tick"
            print(f"{mode}, {clock}: {both}, {old / new:.2f} times as fast")
    return 0


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


def per_tick(tree: Path, mode: str) -> tuple[float, float]:
    """CPU and wall time of one tick of a run from a folder [s]."""
    (cpu, wall), (more_cpu, more_wall) = (_run(tree, mode, ticks) for ticks in (SHORT, LONG))
    return (more_cpu - cpu) / (LONG - SHORT), (more_wall - wall) / (LONG - SHORT)


def _run(tree: Path, mode: str, ticks: int) -> tuple[float, float]:
    with tempfile.TemporaryDirectory() as scratch:
        command = [sys.executable, "-m", "space_robot_cli.main", "run", CASE, "--mode", mode]
        command += ["--set", f"control_period={PERIOD}", "--set", "expect={}", "--out", str(Path(scratch) / "run")]
        command += ["--duration", repr(ticks * PERIOD)]
        # The folder first: an installed tree may be another one.
        environment = os.environ | {"PYTHONPATH": str(tree), "NUMBA_CACHE_DIR": str(tree / ".numba")}
        before, begun = resource.getrusage(resource.RUSAGE_CHILDREN), perf_counter()
        subprocess.run(command, cwd=tree, env=environment, check=True, stdout=subprocess.DEVNULL)
        after, ended = resource.getrusage(resource.RUSAGE_CHILDREN), perf_counter()
    spent = (after.ru_utime + after.ru_stime) - (before.ru_utime + before.ru_stime)
    return spent, ended - begun


if __name__ == "__main__":
    raise SystemExit(main())
