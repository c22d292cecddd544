"""Products and solutions of small dense matrices, row by row: every sum has one order, also where rows are vectors.

An entry is a sum over k in its order; what runs innermost is along a row, which has no sums: a compiler may do several
of its columns at once, and changes no bit.
"""

from __future__ import annotations

from space_robot_description.kernel import jit
from space_robot_description.kernel.jit import called, inner
from space_robot_msgs_py.interfaces import Vector

if jit.MACHINE_CODE:

    @inner
    def add_scaled(out: Vector, scale: float, row: Vector) -> None:
        """Add scale row (c,) to out (c,)."""
        for j in range(out.shape[0]):
            out[j] += scale * row[j]

else:

    def add_scaled(out: Vector, scale: float, row: Vector) -> None:
        """The same products and sums, a row at a time: number by number a design would take a second."""
        out += scale * row


@called
def clear(out: Vector, diagonal: float) -> None:
    """Write zeros into out (r, c), and a number on its diagonal."""
    for i in range(out.shape[0]):
        for j in range(out.shape[1]):
            out[i, j] = diagonal if i == j else 0.0


@called
def copy(a: Vector, out: Vector) -> None:
    """Write a (r, c) into out."""
    for i in range(a.shape[0]):
        for j in range(a.shape[1]):
            out[i, j] = a[i, j]


@called
def transpose(a: Vector, out: Vector) -> None:
    """Write the transpose of a (r, c) into out (c, r)."""
    for i in range(a.shape[0]):
        for j in range(a.shape[1]):
            out[j, i] = a[i, j]


@called
def add_product(a: Vector, b: Vector, out: Vector) -> None:
    """Add a b to out, a (r, s) and b (s, c)."""
    for i in range(a.shape[0]):
        row = out[i]
        for k in range(a.shape[1]):
            add_scaled(row, a[i, k], b[k])


@called
def multiply(a: Vector, b: Vector, out: Vector) -> None:
    """Write a b into out."""
    clear(out, 0.0)
    add_product(a, b, out)


@called
def add_transposed_product(a: Vector, b: Vector, out: Vector) -> None:
    """Add a^T b to out (r, c), a (s, r) and b (s, c)."""
    for k in range(a.shape[0]):
        row = b[k]
        for i in range(a.shape[1]):
            add_scaled(out[i], a[k, i], row)


@called
def add_symmetric(a: Vector, out: Vector) -> float:
    """Add (a + a^T) / 2 to out (s, s); returns the largest magnitude of what was added."""
    largest = 0.0
    for i in range(a.shape[0]):
        for j in range(a.shape[0]):
            change = 0.5 * (a[i, j] + a[j, i])
            out[i, j] += change
            largest = _larger(largest, change)
    return largest


@called
def largest_of(a: Vector) -> float:
    """The largest magnitude in a (r, c)."""
    largest = 0.0
    for i in range(a.shape[0]):
        for j in range(a.shape[1]):
            largest = _larger(largest, a[i, j])
    return largest


@inner
def _larger(largest: float, number: float) -> float:
    """The larger magnitude; what is not a number is larger than anything, and stays."""
    return abs(number) if largest == largest and not abs(number) <= largest else largest


@called
def divide(a: Vector, b: Vector) -> bool:
    """Replace b (s, c) by a^-1 b, and a (s, s) by its LU factors with row pivoting; False: a has no inverse."""
    size = a.shape[0]
    for k in range(size):
        best = k
        for i in range(k + 1, size):
            if abs(a[i, k]) > abs(a[best, k]):
                best = i
        _exchange(a[k], a[best])
        _exchange(b[k], b[best])
        if not abs(a[k, k]) > 0.0:
            return False
        for i in range(k + 1, size):
            share = a[i, k] / a[k, k]
            a[i, k] = share
            add_scaled(a[i, k + 1 :], -share, a[k, k + 1 :])
            add_scaled(b[i], -share, b[k])
    for k in range(size - 1, -1, -1):
        row = b[k]
        for i in range(k + 1, size):
            add_scaled(row, -a[k, i], b[i])
        for j in range(row.shape[0]):
            row[j] /= a[k, k]
    return True


@inner
def _exchange(x: Vector, y: Vector) -> None:
    for j in range(x.shape[0]):
        x[j], y[j] = y[j], x[j]
