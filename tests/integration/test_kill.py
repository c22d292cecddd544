"""The log survives whatever ends the process."""

from __future__ import annotations

import signal
import struct
from pathlib import Path
from time import monotonic, sleep

import numpy as np
import pytest

from space_robot_bringup.experiment.experiment import load_experiment, with_duration
from space_robot_bringup.modes.hooks import Hooks
from space_robot_bringup.modes.run import run_experiment
from space_robot_msgs_py.log.reader import LogReader
from tests.support.follow import DEADLINE, ended
from tests.support.forks import Fork, fork_main

pytest.importorskip("rclpy")
from tests.support.pilot import run_on

pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]
PERIOD = 250_000_000


def wait_for(condition: object, what: str, seconds: float = DEADLINE) -> None:
    end = monotonic() + seconds
    while not condition():  # type: ignore[operator]
        assert monotonic() < end, f"waited {seconds} s for {what}"
        sleep(0.005)


@pytest.mark.slow
def test_sigkill_loses_at_most_one_control_period(tmp_path: Path) -> None:
    """Killed at 20 random instants the file opens and holds every tick without a gap up to the last period."""
    rng = np.random.default_rng(7)
    # Five at a time: each starts, and then waits for its instant.
    for first in range(0, 20, 5):
        places = [tmp_path / f"run{attempt}" for attempt in range(first, first + 5)]
        with ended([Fork(run_on, place, board_of(place)) for place in places]) as pilots:
            for place, pilot in zip(places, pilots, strict=True):
                wait_for(lambda place=place: reached(place) >= 3, "the run to begin")
                sleep(float(rng.uniform(0.0, 0.5)))
                pilot.kill()
                assert pilot.wait() == -signal.SIGKILL
        for place in places:
            assert_whole(LogReader(place), reached(place))


def board_of(place: Path) -> Path:
    """A file of one number: the tick that a run has reached."""
    board = place.with_name(f"{place.name}.board")
    board.write_bytes(struct.pack("<q", -1))
    return board


def reached(place: Path) -> int:
    """What the board of a run says."""
    (tick,) = struct.unpack("<q", place.with_name(f"{place.name}.board").read_bytes())
    return int(tick)


def assert_whole(log: LogReader, tick: int) -> None:
    """Every tick up to the last period is there, of a log that nothing has closed."""
    stamps = [one.stamp for one in log.ticks()]
    assert stamps == [PERIOD * index for index in range(len(stamps))]
    assert len(stamps) >= tick, f"state {tick} was out, but tick {tick - 1} is not in the log"
    assert log.end_reason is None
    assert log.header.seed == 0


@pytest.mark.parametrize("mode", ["headless", "graph", "processes"])
@pytest.mark.parametrize(("number", "reason"), [(signal.SIGINT, "interrupted"), (signal.SIGTERM, "terminated")])
def test_a_signal_closes_the_log_and_says_so(tmp_path: Path, mode: str, number: signal.Signals, reason: str) -> None:
    """Ctrl-C and SIGTERM leave a closed, readable log with the reason in it, exit code 1 and no traceback."""
    run = tmp_path / "run"
    command = ["run", "liu2023/fig08", "--mode", mode, "--out", str(run), "--duration", "250000"]
    with ended([fork_main("space_robot_cli.main", *command)]) as (child,):
        wait_for(lambda: any(path.stat().st_size > 100_000 for path in run.glob("*.mcap")), "some of the run")
        child.send_signal(number)
        stdout, stderr = child.communicate(timeout=DEADLINE)
    assert "Traceback" not in stderr, stderr
    assert child.returncode == 1
    assert reason in stdout
    log = LogReader(run)
    assert log.end_reason == reason
    assert (run / "metadata.yaml").is_file()
    stamps = [tick.stamp for tick in log.ticks()]
    assert len(stamps) > 10
    assert stamps == [PERIOD * tick for tick in range(len(stamps))]


def test_a_busy_graph_stops_at_the_commanded_tick(tmp_path: Path) -> None:
    """A graph whose executor never idles still ends within a tick or two of the wish to stop."""
    reached = 0

    def on_tick(tick: int) -> None:
        nonlocal reached
        reached = tick

    hooks = Hooks(on_tick=on_tick, stop=lambda: "interrupted" if reached >= 50 else None)
    experiment = with_duration(load_experiment("liu2023/fig08"), 2500.0)
    assert run_experiment(experiment, tmp_path / "run", mode="graph", hooks=hooks).end_reason == "interrupted"
    assert reached <= 52
