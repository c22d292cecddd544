"""Both sides of a regression behind one filter, so that differenced rates keep little of their noise."""

from __future__ import annotations

from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.elementary import exp


class FilteredRegression:
    """Y_f = W(s) Y and tau_f = W(s) tau with W(s) = b / (s + b); Y_f pi = tau_f as Y pi = tau.

    What differencing adds of noise, (n[k+1] - n[k]) / T, becomes b (n - W n): neighbouring periods cancel but for the
    share b T, and the bias of least squares, which goes with the square of the noise in Y, falls by (b T)^2.

    Args:
        share: b T, bandwidth of the filter times the period [-].

    Reference: Slotine and Li, "Applied Nonlinear Control", 1991, sec. 8.7.1 and 9.2.3; here in discrete time.
    """

    def __init__(self, share: float) -> None:
        self._keep = exp(-share)
        self._rows: Vector | float = 0.0
        self._values: Vector | float = 0.0

    def update(self, rows: Vector, values: Vector) -> tuple[Vector, Vector]:
        """Return the filtered regression after the rows (m, P) and values (m,) of one more period."""
        rows = self._keep * self._rows + (1.0 - self._keep) * rows
        values = self._keep * self._values + (1.0 - self._keep) * values
        self._rows, self._values = rows, values
        return rows, values
