"""A process that runs until it is killed."""

from __future__ import annotations

import mmap
import struct
from pathlib import Path

from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.hooks import Hooks
from space_robot_bringup.modes.run import run_experiment


def run_on(run: Path, board: Path) -> None:
    """Run fig08 for very long and leave the tick that is reached in shared memory, where a kill cannot hide it."""
    with board.open("r+b") as file, mmap.mmap(file.fileno(), 8) as view:
        hooks = Hooks(on_tick=lambda tick: struct.pack_into("<q", view, 0, tick))
        run_experiment(load_experiment("liu2023/fig08", ["duration=25000.0"]), run, mode="graph", hooks=hooks)
