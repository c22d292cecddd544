"""The log survives whatever ends the process."""

from __future__ import annotations

import mmap
import os
import signal
import struct
import subprocess
import sys
from pathlib import Path
from time import monotonic, sleep

import numpy as np
import pytest

from space_robot_bringup.experiment.experiment import load_experiment, with_duration
from space_robot_bringup.modes.hooks import Hooks
from space_robot_bringup.modes.run import run_experiment
from space_robot_msgs_py.log.reader import LogReader

pytest.importorskip("rclpy")
pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]
PERIOD = 250_000_000

# Flies fig08 for a very long time and leaves the tick it has reached in shared memory, where a kill cannot hide it.
PILOT = """
import mmap, struct, sys
from pathlib import Path
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.hooks import Hooks
from space_robot_bringup.modes.run import run_experiment
file = open(sys.argv[2], "r+b")
board = mmap.mmap(file.fileno(), 8)
hooks = Hooks(on_tick=lambda tick: struct.pack_into("<q", board, 0, tick))
run_experiment(load_experiment("liu2023/fig08", ["duration=25000.0"]), Path(sys.argv[1]), mode="graph", hooks=hooks)
"""


def wait_for(condition: object, what: str, seconds: float = 30.0) -> None:
    end = monotonic() + seconds
    while not condition():  # type: ignore[operator]
        assert monotonic() < end, f"waited {seconds} s for {what}"
        sleep(0.005)


@pytest.mark.slow
def test_sigkill_loses_at_most_one_control_period(tmp_path: Path) -> None:
    """Killed at 20 random instants the file opens and holds every tick without a gap up to the last period."""
    rng = np.random.default_rng(7)
    for attempt in range(20):
        run, board = tmp_path / f"run{attempt}", tmp_path / f"board{attempt}"
        board.write_bytes(struct.pack("<q", -1))
        with board.open("r+b") as file, mmap.mmap(file.fileno(), 8) as view:
            pilot = subprocess.Popen([sys.executable, "-c", PILOT, str(run), str(board)])
            try:
                wait_for(lambda view=view: struct.unpack("<q", view[:8])[0] >= 3, "the flight to begin")
                sleep(float(rng.uniform(0.0, 0.5)))
            finally:
                os.kill(pilot.pid, signal.SIGKILL)
                pilot.wait()
            reached = struct.unpack("<q", view[:8])[0]
        log = LogReader(run)
        stamps = [tick.stamp for tick in log.ticks()]
        assert stamps == [PERIOD * tick for tick in range(len(stamps))]
        assert len(stamps) >= reached, f"state {reached} was out, but tick {reached - 1} is not in the log"
        assert log.end_reason is None
        assert log.header.seed == 0


@pytest.mark.parametrize("mode", ["headless", "graph", "processes"])
@pytest.mark.parametrize(("number", "reason"), [(signal.SIGINT, "interrupted"), (signal.SIGTERM, "terminated")])
def test_a_signal_closes_the_log_and_says_so(tmp_path: Path, mode: str, number: signal.Signals, reason: str) -> None:
    """Ctrl-C and SIGTERM leave a closed, readable log with the reason in it, exit code 1 and no traceback."""
    run = tmp_path / "run"
    command = [sys.executable, "-m", "space_robot_cli", "run", "liu2023/fig08", "--mode", mode, "--out", str(run)]
    flown = subprocess.Popen([*command, "--duration", "250000"], stderr=subprocess.PIPE, stdout=subprocess.PIPE)
    wait_for(lambda: any(path.stat().st_size > 100_000 for path in run.glob("*.mcap")), "some of the flight")
    flown.send_signal(number)
    stdout, stderr = flown.communicate(timeout=60)
    assert b"Traceback" not in stderr, stderr.decode()
    assert flown.returncode == 1
    assert reason.encode() in stdout
    log = LogReader(run)
    assert log.end_reason == reason
    assert (run / "metadata.yaml").is_file()
    stamps = [tick.stamp for tick in log.ticks()]
    assert len(stamps) > 10
    assert stamps == [PERIOD * tick for tick in range(len(stamps))]


def test_a_busy_graph_stops_at_the_tick_it_is_told_to(tmp_path: Path) -> None:
    """A graph whose executor never idles still ends within a tick or two of the wish to stop."""
    reached = 0

    def on_tick(tick: int) -> None:
        nonlocal reached
        reached = tick

    hooks = Hooks(on_tick=on_tick, stop=lambda: "interrupted" if reached >= 50 else None)
    experiment = with_duration(load_experiment("liu2023/fig08"), 2500.0)
    assert run_experiment(experiment, tmp_path / "run", mode="graph", hooks=hooks).end_reason == "interrupted"
    assert reached <= 52
