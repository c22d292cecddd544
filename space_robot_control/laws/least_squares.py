"""Recursive least squares whose covariance cannot lose positive definiteness, with a reset when the world changes."""

from __future__ import annotations

from math import isfinite

import numpy as np

from space_robot_msgs_py.errors import ControlError
from space_robot_msgs_py.interfaces import Vector

BLOW_UP = 1e3  # times the trace that the covariance started with


class RecursiveLeastSquares:
    """pi minimises sum |y - Y pi|^2 + |(pi - pi_0) / spread|^2 over all rows so far.

    The covariance is kept as a square root, G = L L^T. With F = (Y L)^T and S = 1 + F^T F = V diag(s) V^T,

        K = L F S^-1,   L <- L - L F A F^T,   A = V diag(1 / (s + sqrt(s))) V^T,

    which is Andrews' form of (40), (41): G stays positive semidefinite whatever the rounding. There is no forgetting:
    with directions that are never excited the covariance would grow without bound. Instead, when the innovation
    y - Y pi is improbably large several times in a row, the covariance starts anew at the present estimate.

    Args:
        spread: (P,) standard deviation of the start.
        threshold: nu^T S^-1 nu per row above which an innovation is improbable; infinite: never reset.
        samples: improbable innovations in a row that reset.

    Attributes:
        resets: so far.
        surprise: nu^T S^-1 nu per row of the last update; 1 on average for noise as large as announced [-].

    Reference: Liu, Teng, Jin (2023), (39)-(41); Andrews, "A square root formulation of the Kalman covariance
    equations", AIAA Journal 6(6), 1968.
    """

    def __init__(self, spread: Vector, threshold: float, samples: int) -> None:
        self._spread, self._threshold, self._samples = spread, threshold, samples
        self._root = np.diag(spread)
        self._largest = BLOW_UP * float(spread @ spread)
        self._improbable = 0
        self.resets = 0
        self.surprise = 0.0

    @property
    def covariance(self) -> Vector:
        """(P, P) of the estimate, in units of the unit noise of the rows."""
        return self._root @ self._root.T

    @property
    def covariance_trace(self) -> float:
        """Trace of ``covariance``."""
        return float(np.vdot(self._root, self._root))

    def spread_along(self, direction: Vector) -> Vector:
        """Return G d (P,) without forming G."""
        return self._root @ (self._root.T @ direction)

    def correct(self, estimate: Vector, rows: Vector, values: Vector) -> tuple[Vector, Vector]:
        """Return the estimate (P,) after rows of unit noise, and the innovation (m,) they brought.

        Args:
            estimate: (P,) before.
            rows: (m, P) regressor, scaled to unit noise.
            values: (m,) measurements, scaled alike.

        Raises:
            ControlError: the covariance is no longer finite, or has blown up.
        """
        innovation: Vector = values - rows @ estimate
        spread = rows @ self._root
        s, v = np.linalg.eigh(np.identity(values.size) + spread @ spread.T)
        turned = v.T @ innovation
        lift = self._root @ spread.T @ v
        self._root = self._root - (lift / (s + np.sqrt(s))) @ (v.T @ spread)
        self.surprise = float(turned @ (turned / s)) / values.size
        self._watch(float(s[-1]))
        return estimate + lift @ (turned / s), innovation

    def _watch(self, largest_variance: float) -> None:
        trace = self.covariance_trace
        if not isfinite(largest_variance + trace) or trace > self._largest:
            accepted = f"finite, below {self._largest:.3g}"
            raise ControlError("the covariance has blown up", key="covariance_trace", value=trace, accepted=accepted)
        self._improbable = self._improbable + 1 if self.surprise > self._threshold else 0
        if self._improbable >= self._samples:
            self._root = np.diag(self._spread)
            self._improbable = 0
            self.resets += 1
