"""Raw messages by topic: their stamps and their canonical form."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

from space_robot_msgs_py.codec.by_name import conformed
from space_robot_msgs_py.codec.cdr import stamp_of
from space_robot_msgs_py.codec.generic import canonical_message
from space_robot_msgs_py.codec.layout import Layout
from space_robot_msgs_py.codec.statuses import decode_statuses, encode_statuses
from space_robot_msgs_py.codec.supervision import SupervisionCodec
from space_robot_msgs_py.codec.telemetry import TelemetryCodec
from space_robot_msgs_py.codec.texts import decode_events, encode_events, peek_stamp
from space_robot_msgs_py.codec.values import CommandCodec, ReferenceCodec, StateCodec, check_size
from space_robot_msgs_py.codec.wheel_momentum import WheelMomentumCodec
from space_robot_msgs_py.errors import CommandError, LayoutError
from space_robot_msgs_py.limits import TELEMETRY_BYTES
from space_robot_msgs_py.topics import (
    CONTROLLER_EVENTS,
    CONTROLLER_TELEMETRY,
    HOUSEKEEPING,
    PLANT_TELEMETRY,
    SUPERVISOR_MODE,
    TABLE,
    Topic,
)

# What a tick consists of, in the order of the log; what follows from it comes behind it.
LOGGED: tuple[Topic, ...] = tuple(t for t in TABLE if t.recorded and not t.latched and not t.derived)


def value_layouts(joint_names: Sequence[str]) -> dict[Topic, Layout]:
    """The layout of each message of state, reference and command for a robot's joints, in model order."""
    codecs = (StateCodec(joint_names), WheelMomentumCodec(), ReferenceCodec(joint_names), CommandCodec(joint_names))
    return {topic: layout for codec in codecs for topic, layout in zip(codec.topics, codec.layouts, strict=True)}


def telemetry_codecs() -> dict[Topic, TelemetryCodec]:
    """The codec of each telemetry topic."""
    return {topic: TelemetryCodec(topic) for topic in (CONTROLLER_TELEMETRY, PLANT_TELEMETRY, HOUSEKEEPING)}


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

    def reader(self, topic: Topic) -> Callable[[bytes], tuple[int, bytes]]:
        """``read`` for one topic."""
        layout, read = self._layouts.get(topic), partial(self.read, topic)
        if layout is None:
            return read
        cut = layout.cut

        def read_known(raw: bytes) -> tuple[int, bytes]:
            known = cut(raw)
            return read(raw) if known is None else (stamp_of(known[0]), raw)

        return read_known

    def read(self, topic: Topic, raw: bytes) -> tuple[int, bytes]:
        """The stamp [ns] and the canonical bytes of a message.

        Raises:
            LayoutError: it is not a message of the topic's type, or it has no stamp.
        """
        layout = self._layouts.get(topic)
        if layout is not None:
            known = layout.cut(raw)
            if known is not None:
                return stamp_of(known[0]), raw
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
