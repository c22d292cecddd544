"""Raw messages by topic: their stamps, their canonical form, and all of one tick at once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache

import numpy as np

from space_robot_msgs_py.codec.by_name import conformed
from space_robot_msgs_py.codec.generic import canonical_message
from space_robot_msgs_py.codec.layout import Layout
from space_robot_msgs_py.codec.statuses import decode_statuses, encode_statuses, says_none
from space_robot_msgs_py.codec.supervision import SupervisionCodec
from space_robot_msgs_py.codec.telemetry import TelemetryCodec
from space_robot_msgs_py.codec.texts import decode_events, encode_events, peek_stamp
from space_robot_msgs_py.codec.values import CommandCodec, ReferenceCodec, StateCodec, check_size
from space_robot_msgs_py.codec.wheel_momentum import WheelMomentumCodec
from space_robot_msgs_py.errors import CommandError, LayoutError
from space_robot_msgs_py.events import ControllerEvent, DiagnosticEvent
from space_robot_msgs_py.interfaces import (
    ControlOutput,
    PlantSample,
    Reference,
    RobotState,
    Supervision,
    Telemetry,
    Tick,
)
from space_robot_msgs_py.limits import TELEMETRY_BYTES
from space_robot_msgs_py.topics import (
    CONTROLLER_EVENTS,
    CONTROLLER_TELEMETRY,
    EVENTS,
    FAULTS,
    HOUSEKEEPING,
    PLANT_EVENTS,
    PLANT_TELEMETRY,
    SUPERVISOR_MODE,
    TABLE,
    WHEEL_MOMENTUM,
    Topic,
)

# What a tick consists of, in the order of the log; what follows from it comes behind it.
LOGGED: tuple[Topic, ...] = tuple(t for t in TABLE if t.recorded and not t.latched and not t.derived)

# The topics of what happens, in the order of a tick: to the robot, to its commands, and what a supervisor finds.
DIAGNOSTICS: tuple[Topic, ...] = (FAULTS, PLANT_EVENTS, EVENTS)


def value_layouts(joint_names: Sequence[str]) -> dict[Topic, Layout]:
    """The layout of each message of state, reference and command for a robot's joints, in model order."""
    codecs = (StateCodec(joint_names), WheelMomentumCodec(), ReferenceCodec(joint_names), CommandCodec(joint_names))
    return {topic: layout for codec in codecs for topic, layout in zip(codec.topics, codec.layouts, strict=True)}


def telemetry_codecs() -> dict[Topic, TelemetryCodec]:
    """The codec of each telemetry topic."""
    return {topic: TelemetryCodec(topic) for topic in (CONTROLLER_TELEMETRY, PLANT_TELEMETRY, HOUSEKEEPING)}


class TickCodec:
    """A whole tick to and from the messages of ``LOGGED``.

    Args:
        joint_names: the robot's joints in model order.
    """

    def __init__(self, joint_names: Sequence[str]) -> None:
        self.state, self.wheels = StateCodec(joint_names), WheelMomentumCodec()
        self.reference = ReferenceCodec(joint_names)
        self.command = CommandCodec(joint_names)
        self.controller_telemetry = TelemetryCodec(CONTROLLER_TELEMETRY)
        self.plant_telemetry = TelemetryCodec(PLANT_TELEMETRY)
        self.supervision = SupervisionCodec()
        self.housekeeping = TelemetryCodec(HOUSEKEEPING)

    def encode(self, tick: Tick) -> tuple[bytes | None, ...]:
        """The messages of a tick in the order of ``LOGGED``; None where nothing happened.

        Raises:
            LayoutError: its values do not carry one stamp.
        """
        sample, output = tick.sample, tick.output
        values = (sample.state, tick.reference, output.command, output.telemetry, sample.telemetry)
        stamps = [value.stamp for value in values]
        stamps += [event.stamp for event in output.events]
        stamps += [event.stamp for event in (*sample.faults, *sample.events)]
        if stamps.count(tick.stamp) != len(stamps):
            raise LayoutError("values of different stamps", key="tick", value=stamps, accepted="one stamp")
        return (
            *self.state.encode(sample.state),
            self.wheels.of(sample.state),
            *self.reference.encode(tick.reference),
            encode_events(output.events) if output.events else None,
            *self.encode_supervision(tick.stamp, tick.supervision),
            *self.command.encode(output.command),
            *self.controller_telemetry.encode(output.telemetry),
            encode_statuses(sample.faults) if sample.faults else None,
            encode_statuses(sample.events) if sample.events else None,
            *self.plant_telemetry.encode(sample.telemetry),
        )

    def encode_supervision(
        self, stamp: int, found: Supervision | None
    ) -> tuple[bytes | None, bytes | None, bytes | None]:
        """Events, housekeeping and mode; None where there is none.

        Raises:
            LayoutError: its values do not carry this stamp [ns].
        """
        if found is None:
            return None, None, None
        housekeeping = found.housekeeping
        stamps = [found.stamp, *(event.stamp for event in found.events)]
        if any(one != stamp for one in stamps) or (housekeeping is not None and housekeeping.stamp != stamp):
            raise LayoutError("values of different stamps", key="supervision", value=stamps, accepted="one stamp")
        return (
            encode_statuses(found.events) if found.events else None,
            None if housekeeping is None else self.housekeeping.encode(housekeeping)[0],
            self.supervision.encode(found),
        )

    def decode_supervision(self, parts: Mapping[str, bytes], stamp: int) -> Supervision | None:
        """What is recorded of a supervisor at a stamp [ns]; None: no mode.

        Raises:
            LayoutError: a message does not fit its topic, or is of another stamp.
        """
        raw = parts.get(SUPERVISOR_MODE.name)
        if raw is None:
            return None
        found = self.supervision.decode(raw)
        _check_stamp(SUPERVISOR_MODE, stamp, found.stamp)
        summary = parts.get(HOUSEKEEPING.name)
        housekeeping = None if summary is None else _telemetry(self.housekeeping, parts, stamp)
        return replace(found, events=statuses_of(EVENTS, parts, stamp), housekeeping=housekeeping)

    def encode_unanswered(
        self, sample: PlantSample, reference: Reference, supervision: Supervision | None = None
    ) -> tuple[bytes | None, ...]:
        """The messages of a state without an answer, in the order of ``LOGGED``; None where there is none."""
        parts = dict(self.encode_state(sample.state))
        parts |= zip(self.reference.topics, self.reference.encode(reference), strict=True)
        parts[PLANT_TELEMETRY] = self.plant_telemetry.encode(sample.telemetry)[0]
        parts |= {topic: encode_statuses(found) for topic, found in plant_events(sample)}
        said = self.encode_supervision(sample.state.stamp, supervision)
        parts |= {
            topic: raw
            for topic, raw in zip((EVENTS, HOUSEKEEPING, SUPERVISOR_MODE), said, strict=True)
            if raw is not None
        }
        return tuple(parts.get(topic) for topic in LOGGED)

    def encode_state(self, state: RobotState) -> list[tuple[Topic, bytes]]:
        """The messages of a state with their topics; that of the wheels where they are measured."""
        parts = list(zip(self.state.topics, self.state.encode(state), strict=True))
        wheels = self.wheels.of(state)
        return parts if wheels is None else [*parts, (WHEEL_MOMENTUM, wheels)]

    def decode_state(self, parts: Mapping[str, bytes]) -> RobotState:
        """The state in the messages of one stamp, by topic name.

        Raises:
            KeyError: a message of it is not there; that of the wheels need not be.
            LayoutError: a message does not fit its topic, or the stamps differ.
            NonFiniteError: a number is NaN or infinite.
        """
        state = self.state.decode([parts[topic.name] for topic in self.state.topics])
        return self.wheels.added(state, parts.get(WHEEL_MOMENTUM.name))

    def decode(self, parts: Mapping[str, bytes]) -> Tick:
        """The tick in the messages of one stamp, by topic name; telemetry that is not there becomes empty.

        Raises:
            LayoutError: a message does not fit its topic, or the stamps differ (CommandError for commands).
            NonFiniteError: a number is NaN or infinite.
        """
        state = self.decode_state(parts)
        reference = self.reference.decode([parts[topic.name] for topic in self.reference.topics])
        command = self.command.decode([parts[topic.name] for topic in self.command.topics])
        if not state.stamp == reference.stamp == command.stamp:
            stamps = [state.stamp, reference.stamp, command.stamp]
            raise LayoutError("values of different stamps", key="tick", value=stamps, accepted="one stamp")
        return Tick(
            PlantSample(
                state,
                _telemetry(self.plant_telemetry, parts, state.stamp),
                *(statuses_of(topic, parts, state.stamp) for topic in (FAULTS, PLANT_EVENTS)),
            ),
            reference,
            ControlOutput(
                command,
                _telemetry(self.controller_telemetry, parts, state.stamp),
                events_of(parts, state.stamp),
            ),
            self.decode_supervision(parts, state.stamp),
        )


class TopicBytes:
    """Canonical form and stamp of raw messages, topic by topic, as a recorder needs them.

    Bytes that have the layout of this robot are only cleaned, joints are put into its order by their names; other
    messages of the right type (another frame, other joints) go through the general path and keep their content.

    Args:
        joint_names: the robot's joints in model order.
    """

    def __init__(self, joint_names: Sequence[str]) -> None:
        self._layouts = value_layouts(joint_names)
        self._telemetry = telemetry_codecs()
        self._supervision = SupervisionCodec()

    def read(self, topic: Topic, raw: bytes) -> tuple[int, bytes]:
        """The stamp [ns] and the canonical bytes of a message.

        Raises:
            LayoutError: it is not a message of the topic's type, or it has no stamp.
        """
        layout = self._layouts.get(topic)
        if layout is not None and layout.is_canonical(raw):
            return peek_stamp(raw), raw
        if layout is not None:
            check_size(layout, raw)
        if topic is CONTROLLER_EVENTS:
            events = decode_events(raw)
            return events[0].stamp, encode_events(events)
        if topic.kind in ("plant_event", "supervision_event"):
            found = decode_statuses(raw)
            return found[0].stamp, encode_statuses(found)
        if topic is SUPERVISOR_MODE:
            return peek_stamp(raw), self._supervision.canonical(raw)
        telemetry = self._telemetry.get(topic)
        if telemetry is None:
            data = self.canonical(topic, raw)
            return peek_stamp(data), data
        try:
            return telemetry.read(raw)
        except LayoutError:
            TELEMETRY_BYTES.check(len(raw), topic.name, LayoutError)
            return telemetry.read(canonical_message(topic.type, raw))

    def canonical(self, topic: Topic, raw: bytes) -> bytes:
        """The same message with zero padding and nothing behind it.

        Raises:
            LayoutError: it is not a message of the topic's type.
        """
        layout = self._layouts.get(topic)
        if topic in self._telemetry:
            try:
                return self._telemetry[topic].canonical(raw)
            except LayoutError:
                return canonical_message(topic.type, raw)
        if layout is None:
            return canonical_message(topic.type, raw)
        if layout.matches(raw):
            return layout.canonical(raw)
        try:
            return conformed(layout, topic.type, raw)
        except (LayoutError, CommandError):
            return canonical_message(topic.type, raw)


def events_of(parts: Mapping[str, bytes], stamp: int) -> tuple[ControllerEvent, ...]:
    """The events of a tick; none where it has no message of them.

    Args:
        parts: canonical messages by topic name.
        stamp: of the tick [ns].

    Raises:
        LayoutError: the message is unreadable, or of another stamp.
    """
    raw = parts.get(CONTROLLER_EVENTS.name)
    events = () if raw is None else decode_events(raw)
    if events:
        _check_stamp(CONTROLLER_EVENTS, stamp, events[0].stamp)
    return events


def encode_tick_housekeeping(codec: TelemetryCodec, stamp: int, summary: Telemetry | None) -> bytes:
    """The housekeeping of a tick as nodes exchange it: where none is due a message with the stamp alone says so."""
    return codec.encode(summary if summary is not None else Telemetry(stamp, (), (), np.empty(0)))[0]


def is_empty(topic: Topic, raw: bytes) -> bool:
    """Whether a message says that nothing of an optional topic belongs to its stamp; it goes into no log."""
    return len(raw) == _shortest() if topic is HOUSEKEEPING else says_none(raw)


@cache
def _shortest() -> int:
    return len(encode_tick_housekeeping(TelemetryCodec(HOUSEKEEPING), 0, None))


def diagnostics_of(parts: Mapping[str, bytes], stamp: int) -> tuple[DiagnosticEvent, ...]:
    """What happens at a tick: to the robot, to its commands, and what a supervisor found, in this order.

    Args:
        parts: canonical messages by topic name.
        stamp: of the tick [ns].

    Raises:
        LayoutError: a message is unreadable, or of another stamp.
    """
    return tuple(event for topic in DIAGNOSTICS for event in statuses_of(topic, parts, stamp))


def plant_events(sample: PlantSample) -> list[tuple[Topic, tuple[DiagnosticEvent, ...]]]:
    """The events of a sample by the topic they are published on, where there are any."""
    return [(topic, events) for topic, events in ((FAULTS, sample.faults), (PLANT_EVENTS, sample.events)) if events]


def statuses_of(topic: Topic, parts: Mapping[str, bytes], stamp: int) -> tuple[DiagnosticEvent, ...]:
    """The events of a tick on one topic of ``DIAGNOSTICS``; see ``diagnostics_of``."""
    raw = parts.get(topic.name)
    events = () if raw is None else decode_statuses(raw)
    if events:
        _check_stamp(topic, stamp, events[0].stamp)
    return events


def _check_stamp(topic: Topic, stamp: int, found: int) -> None:
    if found != stamp:
        raise LayoutError("parts of different stamps", key=topic.name, value=[stamp, found], accepted="one stamp")


def _telemetry(codec: TelemetryCodec, parts: Mapping[str, bytes], stamp: int) -> Telemetry:
    raw = parts.get(codec.topics[0].name)
    if raw is None:
        return Telemetry(stamp, (), (), np.empty(0))
    telemetry = codec.decode((raw,))
    _check_stamp(codec.topics[0], stamp, telemetry.stamp)
    return telemetry
