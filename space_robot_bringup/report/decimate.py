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
    width = -(-count // buckets)
    starts = width * np.arange(-(-count // width))
    # The last stretch is filled up with its own last value, which is kept anyway.
    rows = np.pad(values, (0, starts.size * width - count), mode="edge").reshape(-1, width)
    extremes = [starts + rows.argmin(axis=1), starts + rows.argmax(axis=1), [0, count - 1]]
    kept: npt.NDArray[np.int64] = np.unique(np.minimum(np.concatenate(extremes), count - 1))
    return kept
