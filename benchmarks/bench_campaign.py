"""A campaign of 100 runs of 150 s with noise and dispersion, on two local workers."""

from __future__ import annotations

import tempfile
from pathlib import Path
from statistics import median

from space_robot_studies.campaign.campaign import run_campaign
from space_robot_studies.campaign.spec import load_campaign
from space_robot_studies.engine.journal import finished_row

RUNS, REPEATS, WORKERS = 100, 3, 2
CAMPAIGN = """
experiment: liu2023/fig08
set: {control_period: 0.1, duration: 150.0, plant.dispersion.eta: 0.1, expect: {}}
runs: 100
disperse:
  initial.attitude_deg: {rotation: {max_deg: 20}}
  plant.sensors.attitude.noise: {uniform: {low: 0.0, high: 1.0e-4}}
"""


def run() -> dict[str, float]:
    """Wall time of running in seconds, without the start of the workers; median of three."""
    walls, each = [], []
    with tempfile.TemporaryDirectory() as scratch:
        file = Path(scratch) / "campaign.yaml"
        file.write_text(CAMPAIGN, encoding="utf-8")
        campaign = load_campaign(str(file), RUNS)
        for repeat in range(REPEATS):
            place = Path(scratch) / str(repeat)
            walls.append(run_campaign(campaign, place, workers=WORKERS, keep="none").wall_time)
            rows = [finished_row(place, index) for index in range(RUNS)]
            each += [row.wall_time for row in rows if row is not None]
    return {
        f"{RUNS} runs of 150 s, {WORKERS} workers: s, median of {REPEATS}": median(walls),
        f"the same, range of {REPEATS}: s": max(walls) - min(walls),
        "one run, all included: s, median": median(each),
    }
