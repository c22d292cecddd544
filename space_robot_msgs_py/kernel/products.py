"""Products of vectors and small matrices with sums of one order: equal bits on every processor.

BLAS, behind ``@``, sums as it suits the processor.
"""

from __future__ import annotations

import numpy as np

from space_robot_msgs_py.interfaces import Vector


def times(a: Vector, b: Vector) -> Vector:
    """Return a b of a (i, j) and b (j,) or (j, k), or of a stack a (m, i, j) and b (j, k)."""
    out: Vector = np.einsum("...ij,j->...i" if b.ndim == 1 else "...ij,jk->...ik", a, b)
    return out


def dot(a: Vector, b: Vector) -> float:
    """Return the sum of a_i b_i."""
    return float(np.sum(np.multiply(a, b)))


def norm(a: Vector) -> float:
    """Return the length of a vector."""
    return float(np.sqrt(dot(a, a)))
