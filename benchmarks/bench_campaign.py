"""Whole commands: campaigns of 100 runs on two local workers; with ``SPACE_ROBOT_BEFORE`` beside an earlier checkout.

``SPACE_ROBOT_BEFORE=/path/to/checkout python -m benchmarks campaign`` lets the two take turns and prints ratios; both
use this environment's libraries, and each its own cache of kernels, the earlier one in its ``out/kernels``.
"""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path
from time import perf_counter

REPEATS, RUNS, WORKERS = 5, 100, 2
CAMPAIGNS = {
    "ntsmc, servicer": "giordano2023/sec5",
    "adaptive, mini": "fig08_dispersed",
    "mfac, servicer": {"experiment": "song2023/servicer", "set": {"duration": 40.0, "expect": {}}},
    "computed_torque, servicer": {"experiment": "compare/servicer", "set": {"expect": {}}},
}
DISPERSED = {"initial.attitude_deg": {"rotation": {"max_deg": 5}}}


def run() -> dict[str, float]:
    """Seconds of the whole command, of its CPU time and of its runs alone; the least of five turns."""
    table: dict[str, float] = {}
    before = os.environ.get("SPACE_ROBOT_BEFORE")
    with tempfile.TemporaryDirectory() as scratch:
        for name, campaign in CAMPAIGNS.items():
            file = campaign if isinstance(campaign, str) else _written(Path(scratch), name, campaign)
            table |= {f"{name}: {what}": value for what, value in measured(file, Path(scratch), before).items()}
    return table


def measured(campaign: str, scratch: Path, before: str | None, repeats: int = REPEATS) -> dict[str, float]:
    """The numbers of one campaign.

    Args:
        campaign: a shipped name or a file.
        scratch: folder for what it leaves.
        before: an earlier checkout; None: there is none.
        repeats: turns.
    """
    codes = {"now": Path(__file__).parents[1]} | ({"before": Path(before)} if before else {})
    least: dict[str, dict[str, float]] = {name: {} for name in codes}
    for turn in range(1 + repeats):
        for name, code in codes.items():
            out = scratch / f"{len(list(scratch.iterdir()))}"
            found = once(campaign, code, out, code / "out" / "kernels" if name == "before" else None)
            # In the first turn kernels are compiled.
            for what, value in found.items() if turn else ():
                least[name][what] = min(least[name].get(what, value), value)
    table = {f"{RUNS} runs, {what}: s": value for what, value in least["now"].items()}
    for what, value in least["now"].items() if before else ():
        table[f"{RUNS} runs, {what}: before over now"] = least["before"][what] / value
    return table


def once(campaign: str, code: Path, out: Path, kernels: Path | None = None) -> dict[str, float]:
    """Seconds of one command.

    Args:
        campaign: a shipped name or a file.
        code: checkout that runs it.
        out: folder for what it leaves.
        kernels: cache of its kernels; None: that of this process.
    """
    module = "space_robot_cli" if (code / "space_robot_cli").is_dir() else "space_robot_bringup"
    words = ["campaign", campaign, "--runs", str(RUNS), "--workers", str(WORKERS), "--out", str(out), "--json"]
    environment = os.environ | {"PYTHONPATH": str(code)}
    if kernels is not None:
        environment["NUMBA_CACHE_DIR"] = str(kernels)
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    used, began = _children(), perf_counter()
    done = subprocess.run(
        [sys.executable, "-m", module, *words],
        env=environment,
        capture_output=True,
        text=True,
        cwd=out.parent,
        check=False,
    )
    wall, cpu = perf_counter() - began, _children() - used
    said = json.loads(done.stdout)
    assert said["done"] == RUNS, done.stderr
    return {"whole command": wall, "CPU of the whole command": cpu, "running, without start": said["wall_time"]}


def _children() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _written(folder: Path, name: str, campaign: Mapping[str, object]) -> str:
    path = folder / f"{name.replace(', ', '_')}.yaml"
    path.write_text(json.dumps({**campaign, "runs": RUNS, "seed": 1, "disperse": DISPERSED}), encoding="utf-8")
    return str(path)
