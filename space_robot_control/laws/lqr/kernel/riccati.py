"""The discrete algebraic Riccati equation by doubling.

Own code, not SciPy's: a law has to run, and its log to replay, where only what every installation has is there, and
with the same bits on every processor. A test compares it with ``scipy.linalg.solve_discrete_are``.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from space_robot_control.kernel.matrices import (
    add_product,
    add_symmetric,
    add_transposed_product,
    clear,
    copy,
    divide,
    largest_of,
    multiply,
    transpose,
)
from space_robot_description.kernel.jit import called
from space_robot_msgs_py.interfaces import Vector

# Every step doubles the number of periods that are looked ahead: 2^40 of them are more than any loop needs.
MAX_DOUBLINGS = 40
CONVERGED = 1e-14
NEWTON_STEPS = 3
SOLVED, UNSOLVED, UNSTABLE = 0, 2, 3


class RiccatiRoom(NamedTuple):
    """Room to work in: A_k, G_k, W_k and four more (s, s), one (s, 2s), B^T (m, s), X B (s, m), (m, m)."""

    f: npt.NDArray[np.float64]
    g: npt.NDArray[np.float64]
    w: npt.NDArray[np.float64]
    wf: npt.NDArray[np.float64]
    wg: npt.NDArray[np.float64]
    first: npt.NDArray[np.float64]
    second: npt.NDArray[np.float64]
    both: npt.NDArray[np.float64]
    bt: npt.NDArray[np.float64]
    xb: npt.NDArray[np.float64]
    small: npt.NDArray[np.float64]


def riccati_room(states: int, inputs: int) -> RiccatiRoom:
    """Room for s states and m inputs."""
    s, m = states, inputs
    f, g, w, wf, wg, first, second = (np.zeros((s, s)) for _ in range(7))
    more = np.zeros((s, 2 * s)), np.zeros((m, s)), np.zeros((s, m)), np.zeros((m, m))
    return RiccatiRoom(f, g, w, wf, wg, first, second, *more)


@called
def solve_riccati(a: Vector, b: Vector, room: RiccatiRoom, cost: Vector, gain: Vector, closed: Vector) -> int:
    """Write X and K of X = A^T X (I + B B^T X)^-1 A + I and K = (I + B^T X B)^-1 B^T X A.

    For x_{k+1} = A x_k + B u_k, u = -K x has the least sum of |x|^2 + |u|^2, which is x^T X x. Structure-preserving
    doubling: with G = B B^T, H = I, W = I + G H, one step is A <- A W^-1 A, G <- G + A W^-1 G A^T,
    H <- H + A^T H W^-1 A, and H tends to X quadratically. Stiff weights cost it digits, which Newton's method gives
    back: X is the cost of the gain so far, and gives the next one (Hewer 1971).

    Args:
        a: (s, s).
        b: (s, m).
        room: overwritten.
        cost: (s, s) written: X, symmetric.
        gain: (m, s) written: K.
        closed: (s, s) written: A - B K.

    Returns:
        SOLVED; UNSOLVED: it does not converge; UNSTABLE: the gain does not stabilise: a mode that no input reaches.

    Reference: Chu, Fan, Lin, Wang, "Structure-preserving algorithms for periodic discrete-time algebraic Riccati
    equations", Int. J. Control 77(8), 2004.
    """
    if not _double(a, b, room, cost) or not _take_gain(a, b, room, cost, gain, closed):
        return UNSOLVED
    for _ in range(NEWTON_STEPS):
        if not _take_cost(gain, closed, room, cost):
            return UNSTABLE
        if not _take_gain(a, b, room, cost, gain, closed):
            return UNSOLVED
    return SOLVED


@called
def _double(a: Vector, b: Vector, room: RiccatiRoom, h: Vector) -> bool:
    """Write X, to as many digits as I + G H leaves. False: it does not converge."""
    f, g, w = room.f, room.g, room.w
    copy(a, f)
    transpose(b, room.bt)
    multiply(b, room.bt, g)
    clear(h, 1.0)
    for _ in range(MAX_DOUBLINGS):
        clear(w, 1.0)
        add_product(g, h, w)
        if not _divide_both(w, f, g, room):
            return False
        multiply(h, room.wf, room.first)
        clear(room.second, 0.0)
        add_transposed_product(f, room.first, room.second)
        change = add_symmetric(room.second, h)
        # W is no longer needed, it has room for A^T.
        transpose(f, w)
        multiply(f, room.wg, room.first)
        add_product(room.first, w, g)
        multiply(f, room.wf, room.first)
        copy(room.first, f)
        size = largest_of(h)
        if size - size != 0.0:
            return False
        if change <= CONVERGED * size:
            return True
    return False


@called
def _divide_both(w: Vector, f: Vector, g: Vector, room: RiccatiRoom) -> bool:
    """Write W^-1 F and W^-1 G, and over W. False: there is no inverse."""
    size = f.shape[0]
    for i in range(size):
        for j in range(size):
            room.both[i, j], room.both[i, size + j] = f[i, j], g[i, j]
    if not divide(w, room.both):
        return False
    for i in range(size):
        for j in range(size):
            room.wf[i, j], room.wg[i, j] = room.both[i, j], room.both[i, size + j]
    return True


@called
def _take_cost(gain: Vector, closed: Vector, room: RiccatiRoom, total: Vector) -> bool:
    """Write the sum of (A^T)^k (I + K^T K) A^k over all k, A closed: Smith's doubling, positive terms alone.

    What is summed is at least |A^k x|^2 of every x: where the sum ends, all poles are inside the unit circle, and where
    one is not, it does not end. False: it does not.
    """
    power = room.f
    copy(closed, power)
    clear(total, 1.0)
    add_transposed_product(gain, gain, total)
    for _ in range(MAX_DOUBLINGS):
        multiply(total, power, room.first)
        clear(room.second, 0.0)
        add_transposed_product(power, room.first, room.second)
        change = add_symmetric(room.second, total)
        multiply(power, power, room.first)
        copy(room.first, power)
        size = largest_of(total)
        if size - size != 0.0:
            return False
        if change <= CONVERGED * size:
            return True
    return False


@called
def _take_gain(a: Vector, b: Vector, room: RiccatiRoom, cost: Vector, gain: Vector, closed: Vector) -> bool:
    """Write K of a cost X, and A - B K. False: there is no inverse."""
    multiply(cost, b, room.xb)
    clear(room.small, 1.0)
    add_transposed_product(b, room.xb, room.small)
    clear(gain, 0.0)
    add_transposed_product(room.xb, a, gain)
    if not divide(room.small, gain):
        return False
    multiply(b, gain, room.first)
    for i in range(a.shape[0]):
        for j in range(a.shape[0]):
            closed[i, j] = a[i, j] - room.first[i, j]
    return True
