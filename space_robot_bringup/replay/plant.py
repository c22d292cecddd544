"""Recorded commands in, fresh states out."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise

from space_robot_bringup.replay.comparison import Tolerance
from space_robot_bringup.replay.recording import Recording
from space_robot_bringup.replay.result import Outcome
from space_robot_bringup.replay.side import SideReplay
from space_robot_msgs_py.codec.codecs import TickCodec, decode_statuses
from space_robot_msgs_py.errors import LogError, SpaceRobotError
from space_robot_msgs_py.events import DiagnosticEvent, said
from space_robot_msgs_py.interfaces import Command, PlantSample, SupervisedPlant, Vector
from space_robot_msgs_py.log.arrays import Row
from space_robot_msgs_py.topics import (
    BASE_ODOM,
    FAULTS,
    PLANT_EVENTS,
    PLANT_TELEMETRY,
    WHEEL_MOMENTUM,
    Topic,
    topics_of,
)

FAILED = "simulator: "
_SHOWN = (*topics_of("state"), PLANT_TELEMETRY)
# The block of the plant's telemetry that says which command acted; see PlantTelemetry.
ACTED = "command_stamp"
# Those that say whether brakes were closed, and wheels unloaded, see ``space_robot_sim.telemetry``.
BRAKES, UNLOADING = "brakes", "unloading"


def replay_plant(recording: Recording, tolerance: Tolerance) -> Outcome:
    """Run a fresh plant from its initial state by the recorded commands and compare what it shows.

    A command acts when the log says it did (``command_stamp`` of the plant's telemetry), which matters in paced runs;
    in a bag without that, when its stamp says.

    Raises:
        LogError: there is nothing to compare.
    """
    return _PlantReplay(recording, tolerance).run()


class _PlantReplay(SideReplay):
    def __init__(self, recording: Recording, tolerance: Tolerance) -> None:
        super().__init__(recording, tolerance)
        self._delay = self._composition.experiment.plant.delay_periods
        self._plant = self._composition.plant()
        self._commands: dict[int, Command] = {}
        self._acted: dict[int, int] = {}
        # Ends of the periods in which brakes were closed, and wheels unloaded.
        self._braked: set[int] = set()
        self._unloaded: set[int] = set()
        self._judged: dict[int, DiagnosticEvent] = {}

    def run(self) -> Outcome:
        rows = [row for row in self._recording.rows() if BASE_ODOM.name in row[1]]
        self._learn(rows)
        if not rows or rows[0][0] != 0 or not self._commands:
            needed = ", ".join(topic.name for topic in (*topics_of("state"), *topics_of("command")))
            accepted = f"{needed} from stamp 0 on"
            raise LogError("nothing to compare with a plant", key=str(self._recording.path), accepted=accepted)
        stop = self._step_through(rows)
        shown = [*_SHOWN, *{WHEEL_MOMENTUM}.intersection(self._composition.optional_topics)]
        return self._outcome("plant", shown, stop)

    def _step_through(self, rows: list[Row]) -> str:
        """Compare row by row; returns why not to the end, or nothing."""
        self._show(rows[0], self._plant.reset())
        for (stamp, _), following in pairwise(rows):
            if following[0] != stamp + self._period:
                return f"states are missing between {stamp} ns and {following[0]} ns: not compared from there on"
            if isinstance(self._plant, SupervisedPlant):
                self._plant.close_brakes(following[0] in self._braked)
                self._plant.unload_wheels(following[0] in self._unloaded)
            try:
                sample = self._plant.step(self._command(stamp))
            except SpaceRobotError as error:
                self._comparison.event("state", following[0], "state", "a state", f"{FAILED}{error}")
                return f"the plant gives up after {stamp} ns"
            self._show(following, sample)
        return self._end(rows[-1][0])

    def _show(self, row: Row, sample: PlantSample) -> None:
        stamp, parts = row
        self._ticks, self._last = self._ticks + 1, stamp
        state = self._codec.encode_state(sample.state)
        telemetry = self._codec.plant_telemetry.encode(sample.telemetry)[0]
        self._comparison.compare(stamp, parts, [*state, (PLANT_TELEMETRY, telemetry)])
        for topic, events in ((FAULTS, sample.faults), (PLANT_EVENTS, sample.events)):
            self._comparison.event(topic.name, stamp, "events", said(self._recorded(topic, parts)), said(events))

    def _recorded(self, topic: Topic, parts: Mapping[str, bytes]) -> tuple[DiagnosticEvent, ...]:
        raw = parts.get(topic.name)
        try:
            return () if raw is None else decode_statuses(raw)
        except SpaceRobotError as error:
            self._notes[f"recorded events cannot be read ({error})"] += 1
            return ()

    def _end(self, stamp: int) -> str:
        """A recorded plant that gave up after the last state has to give up again, for the same reason."""
        if self._ended.startswith(FAILED):
            try:
                self._plant.step(self._command(stamp))
            except SpaceRobotError as error:
                self._comparison.event("state", stamp + self._period, "state", self._ended, f"{FAILED}{error}")
            else:
                self._comparison.event("state", stamp + self._period, "state", self._ended, "a state")
        return ""

    def _learn(self, rows: list[Row]) -> None:
        """Which commands there are, and which of them acted in the period that ended at a stamp."""
        for stamp, parts in rows:
            try:
                raw = [parts[topic.name] for topic in self._codec.command.topics]
                self._commands[stamp] = self._codec.command.decode(raw)
            except KeyError:
                continue
            except SpaceRobotError:
                self._notes["commands were refused and are held over"] += 1
        shown = [(stamp, _telemetry(self._codec, parts)) for stamp, parts in rows]
        self._acted = {stamp: int(blocks[ACTED][0]) for stamp, blocks in shown if ACTED in blocks}
        self._braked = {stamp for stamp, blocks in shown if BRAKES in blocks and blocks[BRAKES].any()}
        self._unloaded = {stamp for stamp, blocks in shown if UNLOADING in blocks and blocks[UNLOADING][0]}
        self._judged = {stamp: found for stamp, parts in rows for found in self._recorded(PLANT_EVENTS, parts)}

    def _command(self, stamp: int) -> Command | None:
        """What the plant was given in the period that begins at a stamp; None: its hold."""
        if self._recording.composition.loses_commands:
            # The plant loses them again.
            return self._commands.get(stamp)
        judged = self._judged.get(stamp + self._period)
        if judged is not None:
            # Not what acted, but what was checked.
            given = dict(judged.values).get("stamp", "")
            return self._commands.get(int(given)) if given.isdecimal() else None
        acted = self._acted.get(stamp + (1 + self._delay) * self._period, stamp)
        if acted != stamp:
            self._notes["periods were run with an older command, or none"] += 1
        found = self._commands.get(acted)
        if found is None and acted >= 0 and acted != stamp:
            self._notes["commands that acted are not in the log"] += 1
        return found


def _telemetry(codec: TickCodec, parts: Mapping[str, bytes]) -> dict[str, Vector]:
    """The blocks that say what acted."""
    raw = parts.get(PLANT_TELEMETRY.name)
    if raw is None:
        return {}
    try:
        blocks = codec.plant_telemetry.decode((raw,)).items()
    except SpaceRobotError:
        return {}
    return {label: block for label, block in blocks if label in (ACTED, BRAKES, UNLOADING) and block.size}
