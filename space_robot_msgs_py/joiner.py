"""Joins messages of equal stamp that arrive one by one, in any order."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from typing import Generic, TypeVar

from space_robot_msgs_py.errors import SpecError

T = TypeVar("T")


class StampJoiner(Generic[T]):
    """Collects the parts of each stamp and gives them out together, once.

    As long as no more than ``capacity`` stamps are under way, the result does not depend on the order of arrival.
    A part that comes twice is taken the first time, unless ``choose`` says otherwise.

    Args:
        parts: how many parts make a whole.
        capacity: how many incomplete stamps are kept; beyond, the one waiting longest is dropped and counted.
        once: True: a stamp that was given out is remembered (the last ``capacity`` of them) and late duplicates are
            ignored. False: it is forgotten, so that time may start again without ``clear``.
        choose: of two items for the same part, the one that is there and the one that comes, the one to keep; given
            with the index of the part.

    Attributes:
        dropped: how many incomplete stamps were given up for lack of room.
    """

    def __init__(
        self, parts: int, capacity: int, *, once: bool = True, choose: Callable[[int, T, T], T] | None = None
    ) -> None:
        if parts < 1 or capacity < 1:
            raise SpecError("nothing to join", key="parts, capacity", value=(parts, capacity), accepted="1 or more")
        self._parts, self._capacity, self._once, self._choose = parts, capacity, once, choose
        # The first key came first, and is the one to give up; an OrderedDict finds it at once.
        self._open: OrderedDict[int, dict[int, T]] = OrderedDict()
        self._done: OrderedDict[int, None] = OrderedDict()
        self._giving_way: set[tuple[int, int]] = set()
        self.dropped = 0

    def __len__(self) -> int:
        """Number of incomplete stamps."""
        return len(self._open)

    def __contains__(self, stamp: int) -> bool:
        """Whether parts of this stamp [ns] wait for others."""
        return stamp in self._open

    def add(self, part_index: int, stamp: int, item: T) -> tuple[T, ...] | None:
        """Take one part; return all parts of its stamp if this was the last one missing.

        Args:
            part_index: which part, from 0.
            stamp: [ns].
            item: what to keep.
        """
        if self._once and stamp in self._done:
            return None
        items = self._open.get(stamp)
        if items is None:
            items = self._open[stamp] = {}
            self._make_room()
        if self._giving_way and (part_index, stamp) in self._giving_way:
            self._giving_way.discard((part_index, stamp))
            items[part_index] = item
        elif part_index in items and self._choose is not None:
            item = self._choose(part_index, items[part_index], item)
            items[part_index] = item
        else:
            items.setdefault(part_index, item)
        if len(items) < self._parts:
            return None
        del self._open[stamp]
        if self._giving_way:
            self._giving_way.difference_update((index, stamp) for index in range(self._parts))
        self._remember(stamp)
        return tuple([items[index] for index in range(self._parts)])

    def let_give_way(self, part_index: int, stamp: int) -> None:
        """Of a part, what waits for stamps later than this one [ns] gives way to the next that comes for them."""
        later = [one for one, items in self._open.items() if one > stamp and part_index in items]
        self._giving_way.update((part_index, one) for one in later)

    def clear(self) -> None:
        """Forget everything but the count of dropped stamps, as at the start of a run."""
        self._open.clear()
        self._giving_way.clear()
        self._done.clear()

    def _remember(self, stamp: int) -> None:
        if self._once:
            self._done[stamp] = None
            if len(self._done) > self._capacity:
                self._done.popitem(last=False)

    def _make_room(self) -> None:
        if len(self._open) > self._capacity:
            self._open.popitem(last=False)
            self.dropped += 1
