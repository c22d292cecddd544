"""Recorded references: of an earlier run, or planned by another program."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise

import numpy as np

from space_robot_description.rotations import normalized
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Reference, Vector


class Recorded:
    """Exactly the given references at exactly their stamps, and rest in the last configuration afterwards.

    There is no interpolation: a stamp between two records, or before the first, is an error.

    Args:
        references: stamps increasing, all of one size.

    Raises:
        SpecError: no reference, stamps that do not increase, different sizes.
    """

    def __init__(self, references: Iterable[Reference]) -> None:
        listed = list(references)
        if not listed:
            raise SpecError("no reference", key="references", value=[], accepted="one or more")
        for before, after in pairwise(listed):
            if after.stamp <= before.stamp:
                value = [before.stamp, after.stamp]
                raise SpecError("stamps do not increase", key="stamps", value=value, accepted="increasing [ns]")
            if after.q.size != before.q.size:
                value = [before.q.size, after.q.size]
                raise SpecError("different sizes", key="q", value=value, accepted="one robot")
        self._records = {reference.stamp: reference for reference in listed}
        self._last = listed[-1]
        self._zero = np.zeros(self._last.v.size)

    @classmethod
    def from_arrays(
        cls,
        stamps: Sequence[int],
        q: Sequence[Sequence[float]] | Vector,
        v: Sequence[Sequence[float]] | Vector,
        a: Sequence[Sequence[float]] | Vector,
        key: str = "reference",
    ) -> Recorded:
        """Build from one row per stamp.

        Args:
            stamps: (m,) increasing [ns].
            q: (m, 7+n) [m, -, rad]; quaternions are taken as they are, but may not be zero.
            v: (m, 6+n) [m/s, rad/s].
            a: (m, 6+n) [m/s2, rad/s2].
            key: what to call the arrays in an error.

        Raises:
            SpecError: different lengths, or see the class.
            CommandError: a row has the wrong size.
            NonFiniteError: a number is not finite.
        """
        lengths = {"q": len(q), "v": len(v), "a": len(a)}
        for name, length in lengths.items():
            if length != len(stamps):
                raise SpecError("wrong number of rows", key=f"{key}.{name}", value=length, accepted=f"{len(stamps)}")
        for row in q:
            normalized(row[3:7], f"{key}.q (quaternion)")
        return cls(
            Reference(int(stamp), np.array(row_q), np.array(row_v), np.array(row_a))
            for stamp, row_q, row_v, row_a in zip(stamps, q, v, a, strict=True)
        )

    def at(self, stamp: int) -> Reference:
        """Return the reference at a stamp [ns].

        Raises:
            SpecError: nothing was recorded for that stamp.
        """
        found = self._records.get(stamp)
        if found is not None:
            return found
        if stamp > self._last.stamp:
            return Reference(stamp, self._last.q, self._zero, self._zero)
        near = min(self._records, key=lambda known: abs(known - stamp))
        raise SpecError("no reference recorded", key="stamp", value=stamp, accepted=f"e.g. {near} [ns]")
