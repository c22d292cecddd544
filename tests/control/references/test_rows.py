"""A reference as arrays over a whole run has the numbers that it gives tick by tick, to the bit."""

from __future__ import annotations

import numpy as np
import pytest

from space_robot_control.references.points import Hold, PointToPoint, Step
from space_robot_control.references.rows import rows_of
from space_robot_msgs_py.errors import NonFiniteError
from space_robot_msgs_py.interfaces import ReferenceSource, Vector

PERIOD, TICKS = 100_000_000, 40


def _configurations(seed: int) -> tuple[Vector, Vector]:
    first, last = np.random.default_rng(seed).standard_normal((2, 10))
    for q in (first, last):
        q[3:7] /= np.linalg.norm(q[3:7])
    # A zero with a sign in what does not change.
    first[0] = last[0] = -0.0
    return first, last


def _sources(seed: int) -> list[ReferenceSource]:
    first, last = _configurations(seed)
    return [Hold(first), Step(first, last, 3 * PERIOD), PointToPoint(first, last, 7 * PERIOD, 20 * PERIOD + 1)]


@pytest.mark.parametrize("seed", range(5))
def test_rows_are_the_bits_of_the_values(seed: int) -> None:
    """Before, on and after its way, a second time too, where the rows are those that were kept."""
    stamps = range(0, TICKS * PERIOD, PERIOD)
    for source in _sources(seed):
        values = [source.at(stamp) for stamp in stamps]
        for _ in range(2):
            q, v, a = rows_of(source, stamps)
            for k, value in enumerate(values):
                for row, one in ((q[k], value.q), (v[k], value.v), (a[k], value.a)):
                    assert row.tobytes() == one.tobytes()


def test_rows_that_are_not_finite_are_refused_as_values_are() -> None:
    """A way so long and so short in time that its acceleration is no number."""
    first, last = _configurations(0)
    last[8] = 1e300
    with pytest.raises(NonFiniteError, match="reference"), np.errstate(all="ignore"):
        rows_of(PointToPoint(first, last, 0, 100), range(0, 200, 10))
