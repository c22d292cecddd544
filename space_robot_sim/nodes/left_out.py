"""What the log of a paced run has to leave out, and whether a command that acted is among it."""

from __future__ import annotations

from collections import Counter

from space_robot_msgs_py.codec.codecs import TelemetryCodec
from space_robot_msgs_py.errors import SpaceRobotError
from space_robot_msgs_py.topics import PLANT_TELEMETRY, Topic
from space_robot_sim.nodes.tick_parts import COMMANDS, MAX_LATE, Parts

# The block of the plant's telemetry that says which command acted in the period that ended at the stamp.
ACTED = "command_stamp"


class LeftOut:
    """Looks at every tick that is written, in order, and counts what came after its tick was.

    Args:
        period: control period [ns].

    Attributes:
        counts: messages that came too late, by topic.
        unrecorded: so many periods were run with a command that is not in the log.
    """

    def __init__(self, period: int) -> None:
        self._period = period
        self._codec = TelemetryCodec(PLANT_TELEMETRY)
        # By tick: 1 where its command is written.
        self._written = bytearray()
        self._answered: list[int] = []
        self.counts: Counter[str] = Counter()
        self.unrecorded = 0

    def add(self, topic: Topic) -> None:
        """A message came too late."""
        self.counts[topic.name] += 1

    def add_answer(self, stamp: int) -> None:
        """A whole answer to this state [ns] came too late."""
        self._answered.append(stamp)

    def answered(self) -> list[int]:
        """Stamps of states [ns] whose answers came too late, since the last call."""
        found, self._answered = self._answered, []
        return found

    def look(self, stamp: int, parts: Parts) -> None:
        """The tick of this stamp [ns] is written."""
        tick, acted = stamp // self._period, self._acted(parts)
        if acted >= 0 and not self._is_written(acted):
            self.unrecorded += 1
        self._written.extend(bytes(tick - len(self._written)))
        self._written.append(parts.keys() >= COMMANDS)

    def report(self) -> list[str]:
        """A line for each thing that the log lacks."""
        lines = []
        if self.unrecorded:
            lines.append(f"{self.unrecorded} periods were run with commands that are not in the log")
        if self.counts:
            what = ", ".join(f"{count} on {name}" for name, count in sorted(self.counts.items()))
            lines.append(f"messages that came more than {MAX_LATE} periods late are not in the log: {what}")
        return lines

    def _acted(self, parts: Parts) -> int:
        raw = parts.get(PLANT_TELEMETRY)
        try:
            blocks = {} if raw is None else dict(self._codec.decode((raw,)).items())
        except SpaceRobotError:
            return -1
        return int(blocks[ACTED][0]) if ACTED in blocks and blocks[ACTED].size else -1

    def _is_written(self, stamp: int) -> bool:
        tick, rest = divmod(stamp, self._period)
        return not rest and tick < len(self._written) and bool(self._written[tick])
