"""A dense quadratic program by PIQP, every time from the beginning, and only where it says that it is solved.

Of piqp, proxsuite, osqp and clarabel PIQP was the fastest and the most exact on boxes of this size, and never called a
wrong answer solved. A solver object that is kept may depend on what it solved before: here each problem gets a new one,
so that a replay gets the same bits.
"""

from __future__ import annotations

from importlib.util import find_spec
from typing import Any

import numpy as np

from space_robot_msgs_py.errors import ControlError, SpecError
from space_robot_msgs_py.extras import install
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.products import times

# Tried in turn: weights that are far apart leave a problem whose gradient has no nine digits.
EXACT, MAX_ITERATIONS = (1e-9, 1e-7), 100
# How far beyond a bound of size 1 an answer may lie; what is left is cut off.
SLACK = 1e-6


def check_installed() -> None:
    """Refuse a controller that could not solve anything.

    Raises:
        SpecError: the package is not installed.
    """
    if find_spec("piqp") is None:
        raise SpecError("needs piqp", key="controller.law", value="mpc", accepted=install("mpc"))


def solve(
    hessian: Vector,
    slope: Vector,
    box: tuple[Vector, Vector],
    rows: Vector,
    slab: tuple[Vector, Vector],
    max_iterations: int = MAX_ITERATIONS,
) -> tuple[Vector, int]:
    """The z that makes 1/2 z^T hessian z + slope^T z least.

    Args:
        hessian: (k, k), symmetric, positive definite.
        slope: (k,).
        box: lower and upper (k,) of z; infinite where there is none.
        rows: (l, k).
        slab: lower and upper (l,) of rows z.
        max_iterations: after which it gives up.

    Returns:
        z (k,) within the box, and the number of iterations, of all tries.

    Raises:
        ControlError: bounds are crossed, a number is not finite, or the solver did not converge.
    """
    import piqp

    for low, high in (box, slab):
        if not (low <= high).all():
            at = int(np.argmin(high - low))
            raise ControlError("bounds are crossed", key="mpc", value=(float(low[at]), float(high[at])))
    if not (np.isfinite(slope).all() and np.isfinite(hessian).all()):
        raise ControlError("the quadratic program is not finite", key="mpc")
    more: dict[str, Any] = {"G": np.asfortranarray(rows), "h_l": slab[0], "h_u": slab[1]} if rows.size else {}
    iterations = 0
    for exact in EXACT:
        solver = piqp.DenseSolver()
        solver.settings.eps_abs = solver.settings.eps_rel = exact
        solver.settings.max_iter, solver.settings.compute_timings = max_iterations, False
        solver.setup(np.asfortranarray(hessian), slope, x_l=box[0], x_u=box[1], **more)
        status = solver.solve()
        iterations += int(solver.result.info.iter)
        if status != piqp.PIQP_MAX_ITER_REACHED:
            break
    if status != piqp.PIQP_SOLVED:
        raise ControlError("the solver did not converge", key="mpc", value=status.name, accepted="PIQP_SOLVED")
    z = np.array(solver.result.x)
    return _within(z, box, times(rows, z), slab), iterations


def _within(z: Vector, box: tuple[Vector, Vector], product: Vector, slab: tuple[Vector, Vector]) -> Vector:
    """Z with rounding beyond the box cut off; more than that is no answer."""
    beyond = np.concatenate([box[0] - z, z - box[1], slab[0] - product, product - slab[1]])
    if not float(beyond.max(initial=0.0)) <= SLACK:
        raise ControlError("the answer of the solver is beyond a limit", key="mpc", value=float(beyond.max()))
    out: Vector = np.clip(z, *box)
    return out
