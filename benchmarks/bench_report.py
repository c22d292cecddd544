"""What a page costs: time and size for a run of 150 s, its reading included."""

from __future__ import annotations

import tempfile
from pathlib import Path
from time import perf_counter

from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.run import run_experiment
from space_robot_report.pages.log_report import write_log_report

RUNS = {"liu2023/fig08": "mini, 4 joints, boxes", "point_to_point/panda_sat": "panda_sat, 7 joints, meshes"}


def run() -> dict[str, float]:
    """Seconds and megabytes of the page of a run of 150 s at 0.1 s."""
    rows: dict[str, float] = {}
    with tempfile.TemporaryDirectory() as scratch:
        for number, (name, what) in enumerate(RUNS.items()):
            bag, page = Path(scratch) / f"run{number}", Path(scratch) / f"run{number}.html"
            overrides = ["duration=150.0", "control_period=0.1", "expect={}"]
            run_experiment(load_experiment(name, overrides), bag, mode="headless")
            begin = perf_counter()
            write_log_report(bag, page)
            rows[f"page of 150 s, {what}, s"] = perf_counter() - begin
            rows[f"page of 150 s, {what}, MB"] = page.stat().st_size / 1e6
    return rows
