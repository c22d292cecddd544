"""A joint that follows another one, as `<mimic>` of a URDF says."""

from __future__ import annotations

from typing import NamedTuple


class Mimic(NamedTuple):
    """A follower: its position is multiplier times that of a joint, plus offset.

    Attributes:
        joint: the joint it follows; one that follows none itself, where a reader has resolved it.
        multiplier: [-, or rad/m, m/rad between an angle and a length].
        offset: [rad or m].
    """

    joint: str
    multiplier: float
    offset: float

    def through(self, leader: Mimic) -> Mimic:
        """The same follower, of what its leader follows: m1 (m2 q + o2) + o1."""
        offset = self.multiplier * leader.offset + self.offset
        return Mimic(leader.joint, self.multiplier * leader.multiplier, offset)
