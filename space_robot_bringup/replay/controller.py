"""Recorded states in, fresh commands out."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress

from space_robot_bringup.compose.supervision import ModeController
from space_robot_bringup.replay.comparison import Tolerance
from space_robot_bringup.replay.recording import Recording, other_code
from space_robot_bringup.replay.result import Outcome
from space_robot_bringup.replay.side import SideReplay
from space_robot_control.laws.recorded_events import apply_event
from space_robot_msgs_py.codec.codecs import decode_events
from space_robot_msgs_py.errors import LogError, SpaceRobotError
from space_robot_msgs_py.events import LATE, RECORDED, ControllerEvent
from space_robot_msgs_py.interfaces import Reference, ReferenceSource, RobotState
from space_robot_msgs_py.log.arrays import Row
from space_robot_msgs_py.topics import BASE_ODOM, CONTROLLER_EVENTS, CONTROLLER_TELEMETRY, topics_of

FAILED = "controller: "
_ANSWERS = (*topics_of("command"), CONTROLLER_TELEMETRY)


def replay_controller(recording: Recording, tolerance: Tolerance) -> Outcome:
    """Feed every recorded state and reference to a fresh controller and compare what it says.

    A reference that is not in the bag is that of the experiment. A state without a recorded answer passed by while the
    controller was inactive (in a paced run; else it would have waited): the fresh law is not asked either, unless the
    log says that the state was answered too late.

    Raises:
        LogError: there is nothing to compare.
    """
    return _ControllerReplay(recording, tolerance).run()


class _ControllerReplay(SideReplay):
    def __init__(self, recording: Recording, tolerance: Tolerance) -> None:
        super().__init__(recording, tolerance)
        self._law = self._composition.controller()
        self._supervised = self._law if isinstance(self._law, ModeController) else None
        self._code = other_code(recording)
        self._source: ReferenceSource = self._composition.reference()
        self._unheard, self._final = _answers(recording.rows(), failed=self._ended.startswith(FAILED))

    def run(self) -> Outcome:
        self._law.reset()
        stop = ""
        for stamp, parts in self._recording.rows():
            stop = self._tick(stamp, parts)
            if stop:
                break
        comparison = self._comparison
        if not comparison.compared and comparison.first is None:
            missing = ", ".join(topic.name for topic in (*topics_of("state"), *topics_of("command")))
            raise LogError(
                "nothing to compare with a controller",
                key=str(self._recording.path),
                accepted=f"{missing}; see info and recover",
            )
        return self._outcome("controller", _ANSWERS, stop, self._code)

    def _tick(self, stamp: int, parts: Mapping[str, bytes]) -> str:
        """Answer one state; returns why nothing more can be compared, or nothing."""
        if BASE_ODOM.name not in parts:
            self._notes["stamps without a state were passed over"] += 1
            return ""
        if self._last >= 0 and stamp != self._last + self._period:
            return f"states are missing between {self._last} ns and {stamp} ns: not compared from there on"
        self._last = stamp
        try:
            state, reference = self._inputs(stamp, parts)
        except (KeyError, SpaceRobotError) as error:
            return f"the state at {stamp} ns cannot be used ({error}): not compared from there on"
        answered = any(topic.name in parts for topic in topics_of("command"))
        if not (answered or stamp == self._final or stamp in self._unheard):
            self._notes["states have no recorded answer and were not compared"] += 1
            return ""
        self._ticks += answered or stamp not in self._unheard
        self._apply_events(parts)
        self._supervise(stamp, parts)
        try:
            output = self._law.update(state, reference)
        except SpaceRobotError as error:
            return self._failed(stamp, f"{FAILED}{error}", answered)
        if not answered and stamp in self._unheard:
            self._notes["states were answered too late for the log, and the answers were not compared"] += 1
            return ""
        if not answered:
            self._comparison.event("command", stamp, "answer", self._ended, "an answer")
            return ""
        command = zip(self._codec.command.topics, self._codec.command.encode(output.command), strict=True)
        telemetry = self._codec.controller_telemetry.encode(output.telemetry)[0]
        self._comparison.compare(stamp, parts, [*command, (CONTROLLER_TELEMETRY, telemetry)])
        fresh = "; ".join(event.line for event in output.events)
        recorded = "; ".join(event.line for event in self._events(parts))
        self._comparison.event(CONTROLLER_EVENTS.name, stamp, "events", recorded, fresh)
        return ""

    def _supervise(self, stamp: int, parts: Mapping[str, bytes]) -> None:
        """The mode that the recorded controller answered in."""
        if self._supervised is None:
            return
        try:
            found = self._codec.decode_supervision(parts, stamp)
            if found is not None:
                self._supervised.check_decision(found)
        except SpaceRobotError as error:
            self._notes[f"recorded modes cannot be read ({error})"] += 1
            return
        if found is None:
            self._notes["states have no recorded mode: the mode before holds"] += 1
        else:
            self._supervised.supervise(found)

    def _apply_events(self, parts: Mapping[str, bytes]) -> None:
        """Apply the recorded events to the fresh law; it reports them itself."""
        for event in self._events(parts):
            try:
                apply_event(self._law, event)
            except SpaceRobotError as error:
                self._notes[f"recorded changes during the run do not fit ({error})"] += 1

    def _events(self, parts: Mapping[str, bytes]) -> tuple[ControllerEvent, ...]:
        raw = parts.get(CONTROLLER_EVENTS.name)
        try:
            return () if raw is None else tuple(one for one in decode_events(raw) if one.kind not in RECORDED)
        except SpaceRobotError as error:
            self._notes[f"recorded events cannot be read ({error})"] += 1
            return ()

    def _inputs(self, stamp: int, parts: Mapping[str, bytes]) -> tuple[RobotState, Reference]:
        state = self._codec.decode_state(parts)
        if not any(topic.name in parts for topic in self._codec.reference.topics):
            return state, self._source.at(stamp)
        return state, self._codec.reference.decode([parts[topic.name] for topic in self._codec.reference.topics])

    def _failed(self, stamp: int, reason: str, answered: bool) -> str:
        """The fresh law gave up: as the recorded one did, or not."""
        self._comparison.event("command", stamp, "answer", "an answer" if answered else self._ended, reason)
        return f"the law gives up at {stamp} ns"


def _answers(rows: Iterable[Row], *, failed: bool) -> tuple[frozenset[int], int]:
    """What a log says of answers that are not in it.

    Args:
        rows: of the log.
        failed: the recorded law gave up.

    Returns:
        Stamps of states that were answered too late, and of the one at which the law gave up, the first one behind all
        that it answered; -1: it did not.
    """
    answered, states = -1, list[int]()
    unheard = set[int]()
    for stamp, parts in rows:
        states += [stamp] if failed and BASE_ODOM.name in parts else []
        if any(topic.name in parts for topic in topics_of("command")):
            answered = stamp
        raw = parts.get(CONTROLLER_EVENTS.name)
        unheard.update(() if raw is None else _too_late(raw))
    newest = max([answered, *unheard])
    return frozenset(unheard), next((stamp for stamp in states if stamp > newest), -1)


def _too_late(raw: bytes) -> Iterator[int]:
    with suppress(SpaceRobotError):
        for event in decode_events(raw):
            stamps = event.content.get("stamps")
            if event.kind == LATE and isinstance(stamps, list):
                yield from (one for one in stamps if isinstance(one, int))
