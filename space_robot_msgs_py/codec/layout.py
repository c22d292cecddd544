"""CDR layouts: where the numbers of a message stand when its strings and sequence lengths are known beforehand."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain, pairwise
from struct import Struct
from typing import Literal

import numpy as np

from space_robot_msgs_py.codec.cdr import (
    ENCAPSULATION,
    MAX_TRAILING,
    TIME,
    UINT32,
    aligned,
    pack_stamp,
    read_primitive,
    unpack_stamp,
)
from space_robot_msgs_py.errors import CommandError, LayoutError, SpaceRobotError
from space_robot_msgs_py.interfaces import Vector

_ALIGNMENT = {"stamp": 4, "string": 4, "uint32": 4, "doubles": 8, "ignored": 8}

Primitive = Literal["stamp", "string", "uint32", "doubles", "ignored"]
ErrorClass = type[LayoutError] | type[CommandError]


@dataclass(frozen=True, slots=True)
class Field:
    """One primitive of a message at its place in the buffer; ``expected`` is what a constant must be."""

    kind: Primitive
    name: str
    start: int
    stop: int
    expected: str | int = 0

    def content(self) -> bytes:
        """The bytes of a constant; zeros where numbers go."""
        if self.kind == "string":
            text = str(self.expected).encode() + b"\0"
            return UINT32.pack(len(text)) + text
        return UINT32.pack(int(self.expected)) if self.kind == "uint32" else bytes(self.stop - self.start)


class LayoutBuilder:
    """Collects the primitives of a message in the order of its definition.

    Args:
        topic: for error messages.
        error: what is raised for bytes that do not fit.
    """

    def __init__(self, topic: str, error: ErrorClass = LayoutError) -> None:
        self._topic, self._error = topic, error
        self._fields: list[Field] = []
        self._end = len(ENCAPSULATION)

    def stamp(self, name: str = "header.stamp") -> LayoutBuilder:
        """A builtin_interfaces/Time that is filled in."""
        return self._add("stamp", name, TIME.size)

    def string(self, text: str, name: str) -> LayoutBuilder:
        """A string that is the same in every message."""
        if "\0" in text:
            raise LayoutError("text with a NUL cannot be sent", key=f"{self._topic}.{name}", value=text)
        return self._add("string", name, len(text.encode()) + 5, text)

    def uint32(self, value: int, name: str) -> LayoutBuilder:
        """A number, often a sequence length, that is the same in every message."""
        return self._add("uint32", name, 4, value)

    def doubles(self, count: int, name: str) -> LayoutBuilder:
        """``count`` float64 that are filled in."""
        return self._add("doubles", name, 8 * count)

    def ignored(self, count: int, name: str) -> LayoutBuilder:
        """``count`` float64 that are zero when written and anything when read, e.g. a covariance."""
        return self._add("ignored", name, 8 * count)

    def sequence(self, count: int, name: str) -> LayoutBuilder:
        """A float64[] of known length that is filled in."""
        return self.uint32(count, name).doubles(count, name)

    def strings(self, texts: Sequence[str], name: str) -> LayoutBuilder:
        """A string[] that is the same in every message."""
        self.uint32(len(texts), name)
        for index, text in enumerate(texts):
            self.string(text, f"{name}[{index}]")
        return self

    def build(self) -> Layout:
        """The finished layout."""
        return Layout(self._topic, self._fields, self._error)

    def _add(self, kind: Primitive, name: str, size: int, expected: str | int = 0) -> LayoutBuilder:
        # Nothing is written for no elements, not even the padding in front of them.
        start = aligned(self._end, _ALIGNMENT[kind]) if size else self._end
        self._end = start + size
        self._fields.append(Field(kind, name, start, self._end, expected))
        return self


class Layout:
    """Encodes and decodes one kind of message by cutting bytes; nothing is done per element.

    Bytes of padding are written as zero and never looked at. Native byte order is taken to be little endian.

    Args:
        topic: for error messages.
        fields: the primitives in order, with their places.
        error: what is raised for bytes that do not fit.
    """

    def __init__(self, topic: str, fields: Sequence[Field], error: ErrorClass = LayoutError) -> None:
        self.topic, self.fields, self.error = topic, tuple(fields), error
        self.size = self.fields[-1].stop if self.fields else len(ENCAPSULATION)
        # What is the same in every message, and the names of the arrays that are not.
        self.texts = {field.name: str(field.expected) for field in self.fields if field.kind == "string"}
        self.arrays = tuple(field.name for field in self.fields if field.kind == "doubles")
        blank = bytearray(self.size)
        blank[:4] = ENCAPSULATION
        for field in self.fields:
            blank[field.start : field.stop] = field.content()
        self.holes = tuple((f.start, f.stop) for f in self.fields if f.kind in ("stamp", "doubles"))
        free = tuple((f.start, f.stop) for f in self.fields if f.kind not in ("string", "uint32"))
        # Constant, hole, constant, ..., constant: one call cuts a message, one slice compares or replaces every other.
        self._constants = tuple(bytes(blank[start:stop]) for start, stop in _gaps(self.holes, self.size))
        self._sizes = tuple(stop - start for start, stop in self.holes)
        self._format = b"%b".join(constant.replace(b"%", b"%%") for constant in self._constants)
        edges = (0, *chain.from_iterable(self.holes), self.size)
        self._cut = Struct("".join(f"{stop - start}s" for start, stop in pairwise(edges)))
        self._constant = tuple((a, b, bytes(blank[a:b])) for a, b in _gaps(free, self.size) if a < b)
        named = ((f.start, f.stop, f.content()) for f in self.fields if f.kind in ("string", "uint32"))
        self._significant = ((0, 2, ENCAPSULATION[:2]), *named)

    def fill(self, *blocks: bytes) -> bytes:
        """The message with these bytes in its holes, in order.

        Raises:
            LayoutError: a block has not the size of its hole.
        """
        if tuple(map(len, blocks)) != self._sizes:
            raise self._wrong_block(blocks)
        return self._format % blocks

    def pattern(self, names: Sequence[str]) -> bytes:
        """The message as a pattern for ``%``, with a named place for each hole, in order."""
        constants = [constant.replace(b"%", b"%%") for constant in self._constants]
        places = [f"%({name})b".encode() for name in names]
        return constants[0] + b"".join(map(bytes.__add__, places, constants[1:]))

    def cut(self, raw: bytes) -> tuple[bytes, ...] | None:
        """The bytes in the holes of a message that ``fill`` could have made, as nearly every one is; None: of another.

        One call cuts the message, one comparison tells.
        """
        if len(raw) == self.size:
            pieces = self._cut.unpack(raw)
            if pieces[::2] == self._constants:
                return pieces[1::2]
        return None

    def blocks(self, raw: bytes) -> tuple[bytes, ...]:
        """The bytes in the holes of a message, in order; inverse of ``fill``.

        Raises:
            LayoutError: size, names, frames or sequence lengths differ (CommandError in the layout of a command).
        """
        blocks = self.cut(raw)
        if blocks is None:
            self._check(raw)
            blocks = tuple(raw[start:stop] for start, stop in self.holes)
        return blocks

    def encode(self, stamp: int, *arrays: Vector) -> bytes:
        """A stamped message with these float64 arrays in its holes."""
        return self.fill(pack_stamp(stamp), *(array.tobytes() for array in arrays))

    def decode(self, raw: bytes) -> tuple[int, list[Vector]]:
        """The stamp [ns] and the arrays of a stamped message: aligned, read-only copies."""
        stamp, *arrays = self.blocks(raw)
        return unpack_stamp(stamp), [np.frombuffer(block) for block in arrays]

    def matches(self, raw: bytes) -> bool:
        """True if the bytes have this layout."""
        if not 0 <= len(raw) - self.size <= MAX_TRAILING:
            return False
        # The comparison of whole stretches fails on padding that is not zero; then only what has a meaning decides.
        return _equal(raw, self._constant) or _equal(raw, self._significant)

    def is_canonical(self, raw: bytes) -> bool:
        """True if ``fill`` could have made these bytes; the fast test that nearly every message passes."""
        return self.cut(raw) is not None

    def canonical(self, raw: bytes) -> bytes:
        """The same content with zero padding and nothing behind it.

        Raises:
            LayoutError: as ``blocks``.
        """
        if self.is_canonical(raw):
            return raw
        self._check(raw)
        parts: list[bytes] = []
        end = 0
        for start, stop, expected in self._constant:
            parts += [raw[end:start], expected]
            end = stop
        return b"".join([*parts, raw[end : self.size]])

    def stack(self, raws: Sequence[bytes]) -> list[Vector]:
        """The holes of many canonical messages at once: one (len(raws), n) array for each, a stamp as two int32.

        Raises:
            LayoutError: a message does not fit.
        """
        for raw in raws:
            if len(raw) != self.size:
                raise self._explain(raw)
        table = np.frombuffer(b"".join(raws), dtype=np.uint8).reshape(len(raws), self.size)
        for start, stop, expected in self._constant:
            wrong = (table[:, start:stop] != np.frombuffer(expected, dtype=np.uint8)).any(axis=1)
            if wrong.any():
                raise self._explain(raws[int(np.flatnonzero(wrong)[0])])
        types = (
            "<i4" if field.kind == "stamp" else "<f8" for field in self.fields if field.kind in ("stamp", "doubles")
        )
        return [
            np.ascontiguousarray(table[:, start:stop]).view(kind)
            for (start, stop), kind in zip(self.holes, types, strict=True)
        ]

    def _check(self, raw: bytes) -> None:
        if not self.matches(raw):
            raise self._explain(raw)

    def _wrong_block(self, blocks: Sequence[bytes]) -> SpaceRobotError:
        fields = (field for field in self.fields if field.kind in ("stamp", "doubles"))
        pairs = zip(fields, self._sizes, map(len, blocks), strict=True)
        field, accepted, size = next(pair for pair in pairs if pair[1] != pair[2])
        key = f"{self.topic}.{field.name}"
        return self.error("wrong size", key=key, value=size / 8, accepted=f"{accepted // 8} numbers")

    def _explain(self, raw: bytes) -> SpaceRobotError:
        """Walk through the actual bytes to the first primitive that is not as expected."""
        if raw[:2] != ENCAPSULATION[:2]:
            accepted = "little-endian CDR, 00 01"
            return self.error("wrong encapsulation", key=self.topic, value=raw[:2].hex(" "), accepted=accepted)
        cursor = len(ENCAPSULATION)
        for field in self.fields:
            size = field.stop - field.start
            start = aligned(cursor, _ALIGNMENT[field.kind]) if size else cursor
            cursor = start + size
            if field.kind in ("string", "uint32"):
                found, cursor = read_primitive(raw, start, field.kind)
                if found != field.expected:
                    what = "wrong text" if field.kind == "string" else "wrong size"
                    return self.error(
                        what, key=f"{self.topic}.{field.name}", value=found, accepted=repr(field.expected)
                    )
        return self.error("wrong length", key=self.topic, value=f"{len(raw)} bytes", accepted=f"{self.size} bytes")


def _equal(raw: bytes, stretches: Sequence[tuple[int, int, bytes]]) -> bool:
    for start, stop, expected in stretches:  # noqa: SIM110 - a generator would double the cost of decoding
        if raw[start:stop] != expected:
            return False
    return True


def _gaps(spans: Sequence[tuple[int, int]], size: int) -> list[tuple[int, int]]:
    """What lies between, before and behind the spans: one more than there are spans."""
    starts = [0, *(stop for _, stop in spans)]
    stops = [*(start for start, _ in spans), size]
    return list(zip(starts, stops, strict=True))
