"""Where the messages of a plain file stand, noted while it is written: its index needs no second look at each."""

from __future__ import annotations

from array import array
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import accumulate
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from space_robot_msgs_py.log.mcap.records import MESSAGE, PREFIX

_HEAD = PREFIX.size + MESSAGE.size
Integers = npt.NDArray[np.uint64]


class Shape:
    """Message records one behind the other, without what differs from one block of such records to the next.

    Args:
        messages: the channel of each, and the size of its data [bytes].

    Attributes:
        channels: of the records.
        offsets: of the records in the block [bytes].
        size: of the block [bytes].
    """

    def __init__(self, messages: list[tuple[int, int]]) -> None:
        self.channels = np.array([channel for channel, _ in messages], dtype=np.uint64)
        *offsets, self.size = accumulate((_HEAD + size for _, size in messages), initial=0)
        self.offsets = np.array(offsets, dtype=np.uint64)


class Stretch(NamedTuple):
    """Successive blocks of a file, which become one chunk.

    Attributes:
        start, stop: where they stand in the file [bytes].
        first, last: stamps [ns].
        entries: by channel, in the order in which the channels come: (n, 2) stamp and offset of each message.
    """

    start: int
    stop: int
    first: int
    last: int
    entries: dict[int, Integers]


@dataclass(slots=True)
class _Blocks:
    """Columns of numbers, a row for each block."""

    starts: array[int]
    stamps: array[int]
    shapes: array[int]


class Positions:
    """Takes blocks of message records in the order of a file, all records of a block of one stamp.

    Attributes:
        start, stop: of the blocks in the file [bytes]; nothing but them stands between.
    """

    def __init__(self) -> None:
        # 20 bytes a block: a million of them are 20 MB.
        self._blocks = _Blocks(array("Q"), array("Q"), array("L"))
        self._shapes: list[Shape] = []
        self._numbers: dict[Shape, int] = {}
        self.start = self.stop = 0

    def add(self, start: int, stamp: int, shape: Shape) -> None:
        """Note a block that begins at a place of the file [bytes], right behind the one before, of a stamp [ns]."""
        blocks = self._blocks
        if not blocks.starts:
            self.start = start
        number = self._numbers.get(shape)
        if number is None:
            number = self._numbers[shape] = len(self._shapes)
            self._shapes.append(shape)
        blocks.starts.append(start)
        blocks.stamps.append(stamp)
        blocks.shapes.append(number)
        self.stop = start + shape.size

    def stretches(self, size: int) -> Iterator[Stretch]:
        """All blocks; a stretch ends where it is longer than a size [bytes] and the stamp changes."""
        starts, stamps = self._blocks.starts, self._blocks.stamps
        begin = 0
        for index in range(1, len(starts)):
            if starts[index] - starts[begin] > size and stamps[index] != stamps[index - 1]:
                yield self._stretch(begin, index, starts[index])
                begin = index
        if starts:
            yield self._stretch(begin, len(starts), self.stop)

    def _stretch(self, begin: int, end: int, stop: int) -> Stretch:
        blocks = self._blocks
        numbers = np.array(blocks.shapes[begin:end])
        starts = np.array(blocks.starts[begin:end], dtype=np.uint64) - np.uint64(blocks.starts[begin])
        stamps = np.array(blocks.stamps[begin:end], dtype=np.uint64)
        channels, pairs = list[Integers](), list[Integers]()
        for number in dict.fromkeys(numbers.tolist()):
            shape, own = self._shapes[number], numbers == number
            offsets = starts[own, None] + shape.offsets
            channels.append(np.broadcast_to(shape.channels, offsets.shape).ravel())
            pairs.append(np.stack([np.broadcast_to(stamps[own, None], offsets.shape), offsets], axis=-1).reshape(-1, 2))
        channel, pair = np.concatenate(channels), np.concatenate(pairs)
        if len(pairs) > 1:
            order = np.argsort(pair[:, 1])
            channel, pair = channel[order], pair[order]
        entries = {one: pair[channel == one] for one in dict.fromkeys(channel.tolist())}
        return Stretch(blocks.starts[begin], stop, blocks.stamps[begin], blocks.stamps[end - 1], entries)
