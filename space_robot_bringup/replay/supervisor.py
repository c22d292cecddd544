"""Recorded states, commands and orders of the ground in, fresh modes and events out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from space_robot_bringup.replay.comparison import Tolerance
from space_robot_bringup.replay.recording import Recording
from space_robot_bringup.replay.result import Outcome
from space_robot_bringup.replay.side import SideReplay
from space_robot_msgs_py.codec.codecs import decode_statuses
from space_robot_msgs_py.errors import LogError, SpaceRobotError
from space_robot_msgs_py.events import DiagnosticEvent, said
from space_robot_msgs_py.interfaces import ControlOutput, Reference, RobotState, Supervision
from space_robot_msgs_py.topics import BASE_ODOM, EVENTS, HOUSEKEEPING, PLANT_EVENTS, SUPERVISOR_MODE, Topic, topics_of
from space_robot_supervisor.reports import orders_in


def replay_supervisor(recording: Recording, tolerance: Tolerance) -> Outcome:
    """Feed what the recorded supervisor knew to a fresh one, and compare modes, events and housekeeping.

    What the ground ordered is in the recorded events, accepted or refused, and is ordered again.

    Raises:
        LogError: there is nothing to compare.
    """
    return _SupervisorReplay(recording, tolerance).run()


class _SupervisorReplay(SideReplay):
    def __init__(self, recording: Recording, tolerance: Tolerance) -> None:
        super().__init__(recording, tolerance)
        supervisor = self._composition.supervisor()
        if supervisor is None:
            accepted = "controller, plant: the run has no supervision"
            raise LogError("nothing to compare with a supervisor", key=str(recording.path), accepted=accepted)
        self._supervisor = supervisor
        self._source = self._composition.reference()
        # The newest answers, of which a supervisor knows one.
        self._answers: dict[int, ControlOutput] = {}

    def run(self) -> Outcome:
        self._supervisor.reset()
        stop = ""
        for stamp, parts in self._recording.rows():
            stop = self._tick(stamp, parts)
            if stop:
                break
        if not self._ticks:
            accepted = f"messages on {SUPERVISOR_MODE.name}"
            raise LogError("nothing to compare with a supervisor", key=str(self._recording.path), accepted=accepted)
        return self._outcome("supervisor", (SUPERVISOR_MODE,), stop)

    def _tick(self, stamp: int, parts: Mapping[str, bytes]) -> str:
        """Look at one state; returns why nothing more can be compared, or nothing."""
        if BASE_ODOM.name not in parts:
            self._notes["stamps without a state were passed over"] += 1
            return ""
        try:
            recorded = self._codec.decode_supervision(parts, stamp)
            if recorded is not None:
                self._compare(parts, recorded, self._decide(stamp, parts, recorded))
                self._ticks, self._last = self._ticks + 1, stamp
            else:
                self._notes["states have no recorded mode and were not compared"] += 1
            self._keep_answer(stamp, parts)
        except (KeyError, SpaceRobotError) as error:
            return f"the tick at {stamp} ns cannot be used ({error}): not compared from there on"
        return ""

    def _decide(self, stamp: int, parts: Mapping[str, bytes], recorded: Supervision) -> Supervision:
        for command in orders_in(recorded.events):
            self._supervisor.order(command)
        answer = self._answers.get(recorded.answer)
        if recorded.answer >= 0 and answer is None:
            self._notes["commands that were known are not in the log"] += 1
        return self._supervisor.update(*self._inputs(stamp, parts), answer, self._monitored(parts))

    def _compare(self, parts: Mapping[str, bytes], recorded: Supervision, fresh: Supervision) -> None:
        stamp = recorded.stamp
        # First what explains the rest.
        self._comparison.event(EVENTS.name, stamp, "events", said(recorded.events), said(fresh.events))
        was, now = (f"{one.mode} since {one.since} ns" for one in (recorded, fresh))
        self._comparison.event(SUPERVISOR_MODE.name, stamp, "mode", was, now)
        _, housekeeping, mode = self._codec.encode_supervision(stamp, replace(fresh, answer=recorded.answer))
        computed: list[tuple[Topic, bytes]] = [] if housekeeping is None else [(HOUSEKEEPING, housekeeping)]
        self._comparison.compare(stamp, parts, computed)
        self._comparison.compared[SUPERVISOR_MODE.name] += 1
        if mode != parts[SUPERVISOR_MODE.name] and was == now:
            was, now = (f"{one.law} with reference {one.reference}" for one in (recorded, fresh))
            self._comparison.event(SUPERVISOR_MODE.name, stamp, "law", was, now)

    def _inputs(self, stamp: int, parts: Mapping[str, bytes]) -> tuple[RobotState, Reference]:
        state = self._codec.decode_state(parts)
        if not any(topic.name in parts for topic in self._codec.reference.topics):
            return state, self._source.at(stamp)
        return state, self._codec.reference.decode([parts[topic.name] for topic in self._codec.reference.topics])

    def _monitored(self, parts: Mapping[str, bytes]) -> tuple[DiagnosticEvent, ...]:
        raw = parts.get(PLANT_EVENTS.name)
        return () if raw is None else decode_statuses(raw)

    def _keep_answer(self, stamp: int, parts: Mapping[str, bytes]) -> None:
        if any(topic.name not in parts for topic in topics_of("command")):
            return
        tick = self._codec.decode(parts)
        self._answers[stamp] = tick.output
        for old in [one for one in self._answers if one < stamp - 1_000 * self._period]:
            del self._answers[old]
