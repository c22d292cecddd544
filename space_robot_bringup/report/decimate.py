"""Fewer points, the same picture: long signals without their repetition but with every peak."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from space_robot_msgs_py.interfaces import Vector

BUCKETS = 500


def min_max(values: Vector, buckets: int = BUCKETS) -> npt.NDArray[np.int64]:
    """Indices of the points to draw: first, last, and of each stretch its smallest and its largest.

    Args:
        values: (K,) signal.
        buckets: number of stretches; up to twice as many points are kept.

    Returns:
        Increasing indices; all of them where there are no more than ``2 * buckets``.
    """
    count = values.size
    if count <= 2 * buckets:
        return np.arange(count)
    edges = np.linspace(0, count, buckets + 1).astype(np.int64)
    kept = {0, count - 1}
    for start, stop in zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True):
        stretch = values[start:stop]
        kept |= {start + int(np.argmin(stretch)), start + int(np.argmax(stretch))}
    return np.array(sorted(kept))
