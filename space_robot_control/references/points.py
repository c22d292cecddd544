"""References that go from configuration to configuration: hold, step, quintic point-to-point."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from space_robot_control.references.profile import in_body, quintic, turned
from space_robot_control.references.rows import identity_of
from space_robot_description.rotations import exp, log, product, relative
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Reference, Vector
from space_robot_msgs_py.kernel.products import dot


class Hold:
    """At rest in one configuration.

    Args:
        q: (7+n,) configuration [m, -, rad].
    """

    def __init__(self, q: Vector) -> None:
        self._q, self._zero = np.array(q), np.zeros(q.size - 1)

    def at(self, stamp: int) -> Reference:
        """Return the reference at a stamp [ns]."""
        return Reference(stamp, self._q, self._zero, self._zero)

    def rows(self, stamps: Sequence[int]) -> tuple[Vector, Vector, Vector]:
        """See ``rows.rows_of``."""
        still = np.zeros((len(stamps), self._zero.size))
        return np.tile(self._q, (len(stamps), 1)), still, still


class Step:
    """At rest in one configuration, from a time on in another.

    Args:
        before: (7+n,) configuration before the step [m, -, rad].
        after: (7+n,) configuration at the step and afterwards [m, -, rad].
        time: of the step [ns].
    """

    def __init__(self, before: Vector, after: Vector, time: int) -> None:
        self._before, self._after, self._time = Hold(before), Hold(after), time

    def at(self, stamp: int) -> Reference:
        """Return the reference at a stamp [ns]."""
        return (self._before if stamp < self._time else self._after).at(stamp)

    def rows(self, stamps: Sequence[int]) -> tuple[Vector, Vector, Vector]:
        """See ``rows.rows_of``."""
        q, v, a = self._after.rows(stamps)
        before = np.array(stamps) < self._time
        q[before] = self._before.at(0).q
        return q, v, a


class PointToPoint:
    """Rest to rest along a straight line and a geodesic, with x(t) = x0 + s(t) (x1 - x0), s quintic.

    The attitude is R(t) = R0 exp(s theta) with the constant rotation vector theta = log(R0^T R1), the short way, so
    that the body rate is s' theta and its derivative s'' theta, in the desired body frame as in the initial one.

    Args:
        first: (7+n,) configuration to start from [m, -, rad].
        last: (7+n,) configuration to end in [m, -, rad].
        start: [ns].
        duration: [ns], positive.

    Attributes:
        last: the last configuration with the sign of quaternion that the motion reaches it with.
        identity: see ``rows.rows_of``.

    Raises:
        SpecError: the duration is not positive.
    """

    def __init__(self, first: Vector, last: Vector, start: int, duration: int) -> None:
        if duration <= 0:
            raise SpecError("not a duration", key="duration", value=duration, accepted="a positive number [ns]")
        end = np.array(last)
        if dot(first[3:7], end[3:7]) < 0.0:
            end[3:7] *= -1.0  # the same attitude, without a jump of sign
        turn = log(relative(first[3:7], end[3:7]))
        self.last = end
        self._first, self._last = first.tolist(), end.tolist()
        self._change = [*(end[:3] - first[:3]).tolist(), *turn, *(end[7:] - first[7:]).tolist()]
        # The first configuration with an empty place for the attitude: one entry per entry of the change.
        self._flat = [*self._first[:3], 0.0, 0.0, 0.0, *self._first[7:]]
        self._zero = [0.0] * len(self._change)
        self._start, self._duration = start, duration
        self.identity = identity_of(first, last, start, duration)

    def at(self, stamp: int) -> Reference:
        """Return the reference at a stamp [ns]."""
        return in_body(stamp, *self.motion(stamp))

    def rows(self, stamps: Sequence[int]) -> tuple[Vector, Vector, Vector]:
        """See ``rows.rows_of``; at rest all ticks have the same row."""
        q, v, a = list[Sequence[float]](), list[Sequence[float]](), list[Sequence[float]]()
        for stamp in stamps:
            motion = self.motion(stamp)
            if not q or motion[0] is not q[-1]:
                body_v, body_a = turned(*motion)
            q.append(motion[0])
            v.append(body_v)
            a.append(body_a)
        return np.array(q), np.array(v), np.array(a)

    def motion(self, stamp: int) -> tuple[list[float], list[float], list[float]]:
        """Return q (7+n,), v and a (6+n,) at a stamp [ns], the linear parts of v and a in the inertial frame."""
        change, seconds = self._change, 1e-9 * self._duration
        s, ds, dds = quintic((stamp - self._start) / self._duration)
        if s == 0.0 or s == 1.0:
            return self._first if s == 0.0 else self._last, self._zero, self._zero
        ds, dds = ds / seconds, dds / (seconds * seconds)
        moved = [s * part for part in change]
        q = [x + dx for x, dx in zip(self._flat, moved, strict=True)]
        q[3:6] = product(self._first[3:7], exp(moved[3:6]))
        return q, [ds * part for part in change], [dds * part for part in change]
