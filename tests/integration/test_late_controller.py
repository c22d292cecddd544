"""Paced, beside a busy core: whenever the controller appears, every command that acted is in the log."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from time import monotonic

import pytest

pytest.importorskip("rclpy")
from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.hooks import Hooks
from space_robot_bringup.modes.processes import run_processes
from space_robot_msgs_py.codec.codecs import TelemetryCodec
from space_robot_msgs_py.errors import InputFileError, LogError
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.topics import JOINT_COMMAND, PLANT_TELEMETRY, WRENCH_COMMAND
from tests.support.busy import burning_core
from tests.support.follow import DEADLINE
from tests.support.replays import replayed

pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]
PERIOD = 250_000_000
OVERRIDES = ("duration=25000.0", "controller={law: ntsmc}", "plant.hold=zero")
ENOUGH = 40


def acted(log: Path) -> Iterator[tuple[int, int]]:
    """Stamp of every state in a log and of the command that acted before it; -1: none."""
    codec = TelemetryCodec(PLANT_TELEMETRY)
    for stamp, parts in LogReader(log).stamps():
        yield stamp, int(codec.decode((parts[PLANT_TELEMETRY.name],))["command_stamp"][0])


class Enough:
    """Ends a run when enough commands have acted in it."""

    def __init__(self, log: Path) -> None:
        self._log, self._looked, self._deadline = log, 0.0, monotonic() + DEADLINE

    def __call__(self) -> str | None:
        now = monotonic()
        assert now < self._deadline, "the controller never came to act"
        if now - self._looked < 1.0:
            return None
        self._looked = now
        with suppress(InputFileError, LogError):
            return "enough" if sum(command >= 0 for _, command in acted(self._log)) > ENOUGH else None
        return None


@pytest.mark.parametrize(
    ("realtime", "late"),
    [
        (20.0, 1.5),
        *(pytest.param(4.0, late, marks=pytest.mark.thorough) for late in (1.5, 5.0, 20.0)),
        *(pytest.param(20.0, late, marks=pytest.mark.thorough) for late in (5.0, 20.0)),
    ],
)
def test_nothing_that_acted_is_missing_in_the_log(realtime: float, late: float, tmp_path: Path) -> None:
    """The others start first, the controller so many seconds later; plant and controller replay equal from that log."""
    place = tmp_path / "run"
    composition, hooks = compose(load_experiment("liu2023/fig08", OVERRIDES)), Hooks(stop=Enough(place))
    with burning_core():
        reason = run_processes(composition, place, realtime=realtime, hooks=hooks, late={"controller": late})
    assert reason == "enough"
    found = list(acted(place))
    assert [stamp for stamp, _ in found] == [PERIOD * tick for tick in range(len(found))]
    rows = LogReader(place).stamps()
    written = {stamp for stamp, parts in rows if {WRENCH_COMMAND.name, JOINT_COMMAND.name} <= parts.keys()}
    assert {command for _, command in found} - {-1} <= written
    result = replayed(place)
    assert result.equal, [(one.against, one.first, one.remarks) for one in result.outcomes]
