"""The 95 % intervals of every study: Wilson's for a share of runs, a bootstrap for a mean or a median."""

from __future__ import annotations

from collections.abc import Callable
from math import sqrt

import numpy as np

from space_robot_msgs_py.interfaces import Vector

# Quantile of the normal distribution at 97.5 %.
Z = 1.959963984540054
RESAMPLES = 2000
SEED = 20231105


def wilson(count: float, of: int) -> tuple[float, float]:
    """Ends of the 95 % interval of a share, which stays inside 0 to 1 (Wilson, J. Am. Stat. Assoc. 22, 1927).

    Args:
        count: how many have it.
        of: of how many; at least 1.
    """
    share, square = count / of, Z * Z / of
    middle, half = share + square / 2.0, Z * sqrt(share * (1.0 - share) / of + square / (4.0 * of))
    low, high = ((middle + side * half) / (1.0 + square) for side in (-1.0, 1.0))
    return (0.0 if count == 0 else max(0.0, low)), (1.0 if count == of else min(1.0, high))


def resampled(values: Vector, reduction: Callable[..., Vector]) -> tuple[float, float]:
    """Ends of the 95 % interval of a mean or median: percentiles of 2,000 resamples, always the same ones (Efron 1979).

    Args:
        values: (N,), one per run; of a single one the ends are the number itself.
        reduction: over an axis.
    """
    value = float(reduction(values, axis=0))
    if values.size < 2:
        return value, value
    drawn = np.random.Generator(np.random.PCG64(SEED)).integers(values.size, size=(RESAMPLES, values.size))
    low, high = np.percentile(reduction(values[drawn], axis=1), [2.5, 97.5])
    return min(value, float(low)), max(value, float(high))
