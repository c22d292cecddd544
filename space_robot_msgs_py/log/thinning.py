"""A long log thinned while it is read: what is drawn of it fits into a bounded memory, and no peak is lost."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from space_robot_msgs_py.interfaces import NANOSECONDS, Vector
from space_robot_msgs_py.log.arrays import LogArrays, Stamps

# A shorter log is kept as it is; a plot shows a thousand points of each signal.
MAX_TICKS = 10_000
# Columns whose extremes are looked for; telemetry of more has the others at equal distances only.
MAX_COLUMNS = 250
MIN_STRETCHES = 16
_FIELDS = ("q", "v", "effort", "base_acceleration", "q_d", "v_d", "a_d", "wrench", "effort_command")
_OPTIONAL = ("wheel_momentum",)


class Thinner:
    """Takes a log block by block and keeps whole ticks: the first and the last, those with an extreme, some between.

    The log is divided into stretches of equal time. Of each, every column keeps its smallest and its largest value, and
    as many ticks again stay at equal distances.

    Args:
        most: ticks that are kept, about; a log of no more is kept as it is. While it is read there may be
            twice as many.

    Attributes:
        ticks: that came in.
    """

    def __init__(self, most: int = MAX_TICKS) -> None:
        self._most = most
        self._blocks: list[tuple[Stamps, Vector]] = []
        self._kept = 0
        self._like: LogArrays | None = None
        self.ticks = 0

    @property
    def thinned(self) -> bool:
        """Some ticks were dropped."""
        return self._kept < self.ticks

    def add(self, arrays: LogArrays) -> None:
        """Take the next block, of the same columns as the others."""
        self._like = arrays if self._like is None else self._like
        self._blocks.append((arrays.stamp, np.hstack([block for _, _, block in _parts(arrays)])))
        self.ticks += arrays.stamp.size
        self._kept += arrays.stamp.size
        if self._kept > 2 * self._most:
            self._thin()

    def arrays(self) -> LogArrays | None:
        """What was kept; None where nothing came in."""
        if self._like is None:
            return None
        if self.ticks > self._most:
            self._thin()
        stamp, table = self._joined()
        named: dict[str, Vector] = {}
        sides: dict[str, dict[str, Vector]] = {"controller": {}, "plant": {}}
        start = 0
        for side, label, block in _parts(self._like):
            columns = table[:, start : start + block.shape[1]]
            start += block.shape[1]
            if side:
                sides[side][label] = columns
            else:
                named[label] = columns
        return LogArrays(stamp=stamp, time=stamp / NANOSECONDS, **named, **sides)  # type: ignore[arg-type]

    def _thin(self) -> None:
        """Drop ticks of all that is kept; extremes of extremes are extremes of the whole."""
        stamp, table = self._joined()
        columns = min(table.shape[1], MAX_COLUMNS)
        stretches = max(MIN_STRETCHES, self._most // (4 * columns))
        between = max(1, self._most // (2 * stretches))
        edges = np.searchsorted(stamp, np.linspace(stamp[0], stamp[-1], stretches + 1)[1:-1])
        chosen = [np.array([0, stamp.size - 1])]
        for a, b in zip([0, *edges], [*edges, stamp.size], strict=True):
            if a < b:
                rows = table[a:b, :columns]
                evenly = np.linspace(a, b - 1, min(between, b - a)).astype(np.int64)
                chosen += [a + rows.argmin(axis=0), a + rows.argmax(axis=0), evenly]
        kept = np.unique(np.concatenate(chosen))
        self._blocks = [(stamp[kept], table[kept])]
        self._kept = kept.size

    def _joined(self) -> tuple[Stamps, Vector]:
        stamps, tables = zip(*self._blocks, strict=True)
        joined = np.concatenate(stamps), np.concatenate(tables)
        self._blocks = [joined]
        return joined


def thinned(blocks: Iterable[LogArrays]) -> LogArrays | None:
    """A log as far as it is drawn; None where it has no block."""
    thinner = Thinner()
    for block in blocks:
        thinner.add(block)
    return thinner.arrays()


def _parts(arrays: LogArrays) -> Iterator[tuple[str, str, Vector]]:
    """Side, label and columns of everything in a log; what is drawn most stands in front."""
    for name in _FIELDS:
        yield "", name, getattr(arrays, name)
    for name in _OPTIONAL:
        if (block := getattr(arrays, name)) is not None:
            yield "", name, block
    for side, blocks in (("plant", arrays.plant), ("controller", arrays.controller)):
        for label, block in blocks.items():
            yield side, label, block
