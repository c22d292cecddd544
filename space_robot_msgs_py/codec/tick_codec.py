"""All messages of one tick at once, to and from its values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from space_robot_msgs_py.codec.statuses import encode_statuses
from space_robot_msgs_py.codec.supervision import SupervisionCodec
from space_robot_msgs_py.codec.telemetry import TelemetryCodec
from space_robot_msgs_py.codec.texts import encode_events
from space_robot_msgs_py.codec.tick_events import check_stamp, events_of, plant_events, statuses_of
from space_robot_msgs_py.codec.topic_bytes import LOGGED
from space_robot_msgs_py.codec.values import CommandCodec, ReferenceCodec, StateCodec
from space_robot_msgs_py.codec.wheel_momentum import WheelMomentumCodec
from space_robot_msgs_py.errors import LayoutError
from space_robot_msgs_py.interfaces import (
    ControlOutput,
    PlantSample,
    Reference,
    RobotState,
    Supervision,
    Telemetry,
    Tick,
)
from space_robot_msgs_py.topics import (
    CONTROLLER_TELEMETRY,
    EVENTS,
    FAULTS,
    HOUSEKEEPING,
    PLANT_EVENTS,
    PLANT_TELEMETRY,
    SUPERVISOR_MODE,
    WHEEL_MOMENTUM,
    Topic,
)


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
        check_stamp(SUPERVISOR_MODE, stamp, found.stamp)
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


def _telemetry(codec: TelemetryCodec, parts: Mapping[str, bytes], stamp: int) -> Telemetry:
    raw = parts.get(codec.topics[0].name)
    if raw is None:
        return Telemetry(stamp, (), (), np.empty(0))
    telemetry = codec.decode((raw,))
    check_stamp(codec.topics[0], stamp, telemetry.stamp)
    return telemetry
