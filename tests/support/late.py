"""Runs whose nodes come and go: how long they last, and what their log has of what acted."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from time import monotonic

from space_robot_msgs_py.codec.codecs import TelemetryCodec
from space_robot_msgs_py.errors import InputFileError, LogError
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.topics import JOINT_COMMAND, PLANT_TELEMETRY, WRENCH_COMMAND
from tests.support.follow import DEADLINE
from tests.support.replays import replayed

PERIOD = 250_000_000
# Commands of the run have to end by themselves, and the plant must not go on with the last one.
OVERRIDES = ("duration=25000.0", "controller={law: ntsmc}", "plant.hold=zero")
ENOUGH = 40


def acted(log: Path) -> Iterator[tuple[int, int]]:
    """Stamp of every state in a log and of the command that acted before it; -1: none."""
    codec = TelemetryCodec(PLANT_TELEMETRY)
    for stamp, parts in LogReader(log).stamps():
        yield stamp, int(codec.decode((parts[PLANT_TELEMETRY.name],))["command_stamp"][0])


class Enough:
    """Ends a run when enough commands have acted in it.

    Args:
        log: of the run.
        count: so many.
    """

    def __init__(self, log: Path, count: int = ENOUGH) -> None:
        self._log, self._count, self._looked, self._deadline = log, count, 0.0, monotonic() + DEADLINE

    def __call__(self) -> str | None:
        now = monotonic()
        assert now < self._deadline, "the controller never came to act"
        if now - self._looked < 1.0:
            return None
        self._looked = now
        return "enough" if self.count > self._count else None

    @property
    def count(self) -> int:
        """Commands that have acted so far."""
        with suppress(InputFileError, LogError):
            return sum(command >= 0 for _, command in acted(self._log))
        return 0


@dataclass(frozen=True, slots=True)
class Tally:
    """What a log has of its run.

    Attributes:
        ticks: states in it.
        gaps: states that are missing between the first and the last.
        acted: commands that acted, by the telemetry of the plant.
        missing: of these, those that it does not have.
        equal: by side of the replay.
    """

    ticks: int
    gaps: int
    acted: int
    missing: int
    equal: dict[str, bool]


def tally(log: Path) -> Tally:
    """Count, and replay."""
    found = list(acted(log))
    whole = {WRENCH_COMMAND.name, JOINT_COMMAND.name}
    written = {stamp for stamp, parts in LogReader(log).stamps() if whole <= parts.keys()}
    commands = {command for _, command in found} - {-1}
    states = {stamp for stamp, _ in found}
    expected = {PERIOD * tick for tick in range(len(found))}
    equal = {one.against: one.first is None and not one.absent for one in replayed(log).outcomes}
    return Tally(len(found), len(expected - states), len(commands), len(commands - written), equal)
