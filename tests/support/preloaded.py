"""What a fork need not do again: imported by the process that forks, it loads the commands and compiles the kernels."""

from __future__ import annotations

import tempfile
from contextlib import suppress
from importlib import import_module
from pathlib import Path

from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.run import run_experiment

for name in (
    "space_robot_cli.main",
    "space_robot_bringup.nodes.process",
    "space_robot_bringup.nodes.lifecycle_manager",
):
    with suppress(ImportError):
        import_module(name)

with tempfile.TemporaryDirectory() as place:
    run_experiment(load_experiment("liu2023/fig08", ["duration=0.5"]), Path(place) / "run", mode="headless")
