"""A reference as arrays over a whole run."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from space_robot_msgs_py.interfaces import ReferenceSource, Vector


def rows_of(source: ReferenceSource, stamps: Sequence[int]) -> tuple[Vector, Vector, Vector]:
    """Return q (K, 7+n), v and a (K, 6+n) at K stamps [ns], with the bits of ``at``.

    A source that knows them without looking at every stamp has a method ``rows`` for it.
    """
    known: Any = getattr(source, "rows", None)
    if known is not None:
        q, v, a = known(stamps)
        return q, v, a
    found = [source.at(stamp) for stamp in stamps]
    return np.array([one.q for one in found]), np.array([one.v for one in found]), np.array([one.a for one in found])
