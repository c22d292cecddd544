"""The discrete algebraic Riccati equation by doubling, in NumPy alone.

Own code, not SciPy's: a law has to run, and its log to replay, where only what every installation has is there. A test
compares it with ``scipy.linalg.solve_discrete_are``.
"""

from __future__ import annotations

import numpy as np

from space_robot_msgs_py.errors import ControlError
from space_robot_msgs_py.interfaces import Vector

# Every step doubles the number of periods that are looked ahead: 2^40 of them are more than any loop needs.
MAX_DOUBLINGS = 40
CONVERGED = 1e-14
NEWTON_STEPS = 3


def solve_riccati(a: Vector, b: Vector) -> tuple[Vector, Vector]:
    """Return X and K of X = A^T X (I + B B^T X)^-1 A + I and K = (I + B^T X B)^-1 B^T X A.

    For x_{k+1} = A x_k + B u_k, u = -K x has the least sum of |x|^2 + |u|^2, which is x^T X x. Structure-preserving
    doubling: with G = B B^T, H = I, W = I + G H, one step is A <- A W^-1 A, G <- G + A W^-1 G A^T,
    H <- H + A^T H W^-1 A, and H tends to X quadratically. Stiff weights cost it digits, which Newton's method gives
    back: X is the cost of the gain so far, and gives the next one (Hewer 1971).

    Args:
        a: (s, s).
        b: (s, m).

    Returns:
        X (s, s), symmetric, and K (m, s).

    Raises:
        ControlError: it does not converge, or the gain does not stabilise: a mode that no input reaches.

    Reference: Chu, Fan, Lin, Wang, "Structure-preserving algorithms for periodic discrete-time algebraic Riccati
    equations", Int. J. Control 77(8), 2004.
    """
    gain = _gain(a, b, _doubled(a, b))
    for _ in range(NEWTON_STEPS):
        radius = float(np.abs(np.linalg.eigvals(a - b @ gain)).max())
        if not radius < 1.0:
            raise ControlError("the gain does not stabilise", key="K", value=radius, accepted="all poles inside 1")
        cost = _cost(a - b @ gain, gain)
        gain = _gain(a, b, cost)
    return cost, gain


def _doubled(a: Vector, b: Vector) -> Vector:
    """X, to as many digits as I + G H leaves."""
    eye, f, g, h = np.identity(a.shape[0]), a, b @ b.T, np.identity(a.shape[0])
    for _ in range(MAX_DOUBLINGS):
        try:
            both = np.linalg.solve(eye + g @ h, np.hstack((f, g)))
        except np.linalg.LinAlgError:
            break
        wf, wg = both[:, : f.shape[1]], both[:, f.shape[1] :]
        step = f.T @ h @ wf
        f, g, h = f @ wf, g + f @ wg @ f.T, h + 0.5 * (step + step.T)
        if not np.isfinite(h).all():
            break
        if np.abs(step).max() <= CONVERGED * np.abs(h).max():
            return h
    raise ControlError("the Riccati equation has no solution that is found", key="X", accepted="a model with inputs")


def _cost(closed: Vector, gain: Vector) -> Vector:
    """The sum of (A^T)^k (I + K^T K) A^k over all k, for a stable A: Smith's doubling, positive terms alone."""
    total = np.identity(closed.shape[0]) + gain.T @ gain
    for _ in range(MAX_DOUBLINGS):
        step = closed.T @ total @ closed
        total, closed = total + 0.5 * (step + step.T), closed @ closed
        if np.abs(step).max() <= CONVERGED * np.abs(total).max():
            break
    return total


def _gain(a: Vector, b: Vector, cost: Vector) -> Vector:
    return np.array(np.linalg.solve(np.identity(b.shape[1]) + b.T @ cost @ b, b.T @ cost @ a))
