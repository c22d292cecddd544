"""A campaign of a few short runs, laws that fail, and how both are followed."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from time import monotonic, sleep
from typing import Any

import pytest

from tests.support.paths import ROOT

pq = pytest.importorskip("pyarrow.parquet")
pytest.importorskip("scipy")
from space_robot_studies.campaign.campaign import CampaignResult, run_campaign  # noqa: E402
from tests.support.follow import DEADLINE, ended  # noqa: E402

# Some of the cases fail: how far the base turns meanwhile depends on what was drawn.
CAMPAIGN = """
title: test
experiment: liu2023/fig08
set:
  duration: 4.0
  expect: {base/pitch.max_error: {max: 6.0}}
runs: 12
seed: 2
disperse:
  initial.attitude_deg: {rotation: {max_deg: 20}}
  plant.payload.mass: {uniform: {low: 0.1, high: 2.0}}
  plant.sensors.attitude.noise: {normal: {mean: 1.0e-3, std: 1.0e-5}}
vary:
  plant.delay_periods: [0, 1]
"""
# Every way in which a law can end a run, between two that are fine.
LAWS = """
title: laws that fail
experiment: liu2023/fig08
set: {duration: 2.0, expect: {}, controller.gains: {}}
runs: 1
vary:
  controller.law:
    fine: computed_torque
    gives up: tests.support.laws:GivesUp
    buggy: tests.support.laws:Buggy
    exits: tests.support.laws:Exits
    deadly: tests.support.laws:Deadly
    leaves: tests.support.laws:Leaves
    endless: tests.support.laws:Endless
    waits: tests.support.laws:Waits
    fine too: computed_torque
"""


def write(folder: Path, text: str = CAMPAIGN) -> Path:
    """The file of a campaign."""
    path = folder / "test.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def run_in(folder: Path, name: str, text: str = CAMPAIGN, **options: Any) -> CampaignResult:
    """Run it into a directory of that name."""
    return run_campaign(write(folder, text), folder / name, **options)


def results(directory: Path) -> list[bytes]:
    """What must be the same: table and summary."""
    return [(directory / name).read_bytes() for name in ("table.parquet", "summary.json")]


def rows(directory: Path) -> list[dict[str, Any]]:
    """Those of its table."""
    found: list[dict[str, Any]] = pq.read_table(directory / "table.parquet").to_pylist()
    return found


def wait_for(condition: Callable[[], Any], what: str, seconds: float = DEADLINE) -> None:
    """Wait until it holds."""
    end = monotonic() + seconds
    while not condition():
        assert monotonic() < end, f"waited {seconds} s for {what}"
        sleep(0.01)


def finished(directory: Path) -> int:
    """How many runs its journal has."""
    path = directory / "rows.jsonl"
    return max(0, path.read_bytes().count(b"\n") - 1) if path.exists() else 0


@contextmanager
def started(*arguments: str) -> Iterator[subprocess.Popen[str]]:
    """A process in a session of its own that does not outlive the block."""
    process = subprocess.Popen(
        [sys.executable, "-m", *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        cwd=ROOT,
        start_new_session=True,
    )
    with ended([process]):
        yield process


REASONS = {
    "fine": "completed",
    "gives up": "controller: gives_up: patience: enough at t = 0.5 s",
    "buggy": "bug: KeyError: 'a typo'",
    "exits": "controller: law exits at tick 2: SystemExit: enough of this",
    "deadly": "lost: the worker process was killed by SIGKILL",
    "leaves": "lost: the worker process exited with status 7",
    "endless": "timeout: more than 0.5 s of CPU time",
    "waits": "timeout: more than 5 s, most of them waiting",
    "fine too": "completed",
}


def without(*laws: str) -> str:
    """The campaign of failing laws without some of them."""
    return "\n".join(line for line in LAWS.splitlines() if not line.strip().startswith(laws))


def reasons(directory: Path) -> dict[str, str]:
    """Why the run of each law ended."""
    return {row["controller.law"]: row["end_reason"] for row in rows(directory)}
