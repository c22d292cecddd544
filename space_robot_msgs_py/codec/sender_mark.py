"""A mark of its publisher in a message: two of the bytes that CDR leaves undefined, which no other reader looks at.

The middleware does not tell which publisher a message came from, so that of two nodes that command one could give the
wrench and the other the joint efforts. The parts that a node sends as one value carry its mark, and only parts of one
mark are joined. The mark follows from the identity of the publisher, which the graph knows: it names the sender.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from zlib import crc32

from space_robot_msgs_py.codec.layout import Layout
from space_robot_msgs_py.errors import LayoutError

SIZE = 2
UNMARKED = bytes(SIZE)


def mark_of(identity: bytes) -> bytes:
    """The mark of the publisher with this identity; never ``UNMARKED``."""
    return (crc32(identity) % 0xFFFF + 1).to_bytes(SIZE, "little")


class SenderMark:
    """Puts marks into the parts of a value, and takes them out again.

    Args:
        layouts: of the parts.

    Raises:
        LayoutError: a layout has no padding for it.
    """

    def __init__(self, layouts: Sequence[Layout]) -> None:
        self._places = [_padding(layout) for layout in layouts]
        self._lengths = [layout.size for layout in layouts]

    def put(self, parts: Sequence[bytes], mark: bytes) -> tuple[bytes, ...]:
        """The parts, marked."""
        return tuple([raw[:place] + mark + raw[place + SIZE :] for raw, place in zip(parts, self._places, strict=True)])

    def read(self, index: int, raw: bytes) -> bytes:
        """What stands in the place of the mark of a part: of an unmarked message it may be anything."""
        place = self._places[index]
        return raw[place : place + SIZE]

    def remove(self, index: int, raw: bytes) -> bytes:
        """The part with zero padding in that place; a message of another length stays as it is."""
        place = self._places[index]
        if len(raw) != self._lengths[index] or raw[place : place + SIZE] == UNMARKED:
            return raw
        return raw[:place] + UNMARKED + raw[place + SIZE :]


def _padding(layout: Layout) -> int:
    """Where the first padding of a message is that is large enough."""
    for before, behind in pairwise(layout.fields):
        if behind.start - before.stop >= SIZE:
            return before.stop
    raise LayoutError("no padding for a mark", key=layout.topic)
