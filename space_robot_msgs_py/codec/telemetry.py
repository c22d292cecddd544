"""Telemetry as std_msgs/Float64MultiArray: labelled blocks, the first of which is the stamp."""

from __future__ import annotations

import struct
from collections.abc import Sequence

import numpy as np

from space_robot_msgs_py.codec.cdr import ENCAPSULATION, UINT32, aligned
from space_robot_msgs_py.codec.layout import Layout
from space_robot_msgs_py.codec.message_layouts import multi_array
from space_robot_msgs_py.errors import LayoutError
from space_robot_msgs_py.interfaces import Telemetry
from space_robot_msgs_py.limits import TELEMETRY_BLOCKS, TELEMETRY_BYTES
from space_robot_msgs_py.topics import Topic

STAMP = "stamp"
# float64 counts nanoseconds exactly up to here: 104 days.
MAX_STAMP = 1 << 53
MAX_CACHED = 64
_DOUBLE = struct.Struct("<d")

Shape = tuple[tuple[str, ...], tuple[int, ...]]


class TelemetryCodec:
    """Telemetry of one topic to and from bytes; the layout is found at the first message and kept.

    Args:
        topic: the row of the table.

    Attributes:
        topics: that row alone.
    """

    def __init__(self, topic: Topic) -> None:
        self.topics = (topic,)
        self._cache: dict[Shape, Layout] = {}
        self._last: tuple[Shape, Layout] | None = None

    def encode(self, value: Telemetry) -> tuple[bytes]:
        """The message of a telemetry value.

        Raises:
            LayoutError: the stamp is not exact in float64, or a label is used twice or is ``stamp``.
        """
        if not 0 <= value.stamp < MAX_STAMP:
            raise LayoutError(
                "stamp cannot be written", key=self._key(STAMP), value=value.stamp, accepted="0 to 2^53 ns"
            )
        layout = self._layout((value.labels, value.sizes))
        return (layout.fill(_DOUBLE.pack(value.stamp), value.data.tobytes()),)

    def decode(self, parts: Sequence[bytes]) -> Telemetry:
        """The telemetry in the one message of ``parts``.

        Raises:
            LayoutError: the message is not a list of labelled blocks that begins with the stamp.
            NonFiniteError: a number is NaN or infinite.
        """
        (labels, sizes), (head, data) = self._blocks(parts[0])
        stamp = self._stamp(head)
        return Telemetry(stamp, labels, sizes, np.frombuffer(data))

    def decode_part(self, index: int, raw: bytes) -> tuple[int, bytes]:
        """The stamp [ns] and the bytes of all other blocks; ``index`` is 0, there is one part."""
        head, data = self._blocks(raw)[1]
        return self._stamp(head), data

    def read(self, raw: bytes) -> tuple[int, bytes]:
        """The stamp [ns] of a message, and the same message with zero padding and nothing behind it."""
        known = None if self._last is None else self._last[1].cut(raw)
        if known is not None:
            return self._stamp(known[0]), raw
        layout = self.layout_of(raw)
        return self._stamp(layout.blocks(raw)[0]), layout.canonical(raw)

    def canonical(self, raw: bytes) -> bytes:
        """The same message with zero padding and nothing behind it."""
        return self.layout_of(raw).canonical(raw)

    def shape(self, raw: bytes) -> Shape:
        """Labels and sizes of the blocks of a message, without the stamp."""
        return self._find(raw)[0]

    def layout_of(self, raw: bytes) -> Layout:
        """The layout of a message."""
        return self._find(raw)[1]

    def layout_for(self, shape: Shape) -> Layout:
        """The layout of messages of these labels and sizes.

        Raises:
            LayoutError: a label is used twice or is ``stamp``.
        """
        return self._layout(shape)

    def _blocks(self, raw: bytes) -> tuple[Shape, tuple[bytes, ...]]:
        last = self._last
        if last is not None and (known := last[1].cut(raw)) is not None:
            return last[0], known
        shape, layout = self._find(raw)
        return shape, layout.blocks(raw)

    def _find(self, raw: bytes) -> tuple[Shape, Layout]:
        last = self._last
        if last is None or not (last[1].is_canonical(raw) or last[1].matches(raw)):
            shape = self._parse(raw)
            last = self._last = shape, self._layout(shape)
        return last

    def _layout(self, shape: Shape) -> Layout:
        layout = self._cache.get(shape)
        if layout is None:
            labels, sizes = shape
            if STAMP in labels or len(set(labels)) != len(labels):
                accepted = f"labels that differ, none of them {STAMP!r}"
                raise LayoutError("labels are ambiguous", key=self._key("layout.dim"), value=labels, accepted=accepted)
            if len(self._cache) >= MAX_CACHED:
                self._cache.clear()
            layout = self._cache[shape] = multi_array(self.topics[0].name, (STAMP, *labels), (1, *sizes))
        return layout

    def _stamp(self, head: bytes) -> int:
        (value,) = _DOUBLE.unpack(head)
        if not 0 <= value < MAX_STAMP or not value.is_integer():
            raise LayoutError("not a stamp", key=self._key(STAMP), value=value, accepted="whole ns from 0 to 2^53")
        return int(value)

    def _parse(self, raw: bytes) -> Shape:
        """Labels and sizes of a message nothing is known about."""
        TELEMETRY_BYTES.check(len(raw), self.topics[0].name, LayoutError)
        try:
            labels, sizes = _read_dimensions(raw)
        except (struct.error, IndexError, UnicodeDecodeError):
            raise LayoutError("not a Float64MultiArray", key=self.topics[0].name, value=f"{len(raw)} bytes") from None
        if labels[:1] != (STAMP,) or sizes[0] != 1 or 8 * sum(sizes) > len(raw):
            found = ", ".join(f"{label}({size})" for label, size in zip(labels, sizes, strict=True))
            accepted = "blocks stamp(1), ... that fill the message"
            raise LayoutError("wrong blocks", key=self._key("layout.dim"), value=found, accepted=accepted)
        return labels[1:], sizes[1:]

    def _key(self, field: str) -> str:
        return f"{self.topics[0].name}.{field}"


def _read_dimensions(raw: bytes) -> Shape:
    if raw[:2] != ENCAPSULATION[:2]:
        raise IndexError
    (count,) = UINT32.unpack_from(raw, 4)
    TELEMETRY_BLOCKS.check(count, "layout.dim", LayoutError)
    cursor = 8
    labels, sizes = [], []
    for _ in range(count):
        cursor = aligned(cursor, 4)
        (length,) = UINT32.unpack_from(raw, cursor)
        labels.append(raw[cursor + 4 : cursor + 4 + length].removesuffix(b"\0").decode())
        cursor = aligned(cursor + 4 + length, 4)
        sizes.append(UINT32.unpack_from(raw, cursor)[0])
        cursor += 8
    return tuple(labels), tuple(sizes)
