"""Recursive least squares whose covariance cannot lose positive definiteness, with a reset on improbable data."""

from __future__ import annotations

from math import inf, isfinite

import numpy as np

from space_robot_control.laws.adaptive.kernel.least_squares import correct, covariance_times
from space_robot_msgs_py.errors import ControlError
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.products import dot

MAX_GROWTH = 1e3  # of the trace of the covariance, over that of its start


class RecursiveLeastSquares:
    """pi minimises sum |y - Y pi|^2 + |(pi - pi_0) / spread|^2 over all rows so far.

    The covariance is kept as a square root, G = L L^T, and corrected row by row: with f = L^T y and s = 1 + f . f,

        pi <- pi + L f (value - y . pi) / s,   L <- L - L f f^T / (s + sqrt(s)),

    which is Potter's form of (40), (41): G stays positive semidefinite whatever the rounding. There is no forgetting:
    with directions that are never excited the covariance would grow without bound. Instead, when the innovation
    y - Y pi is improbably large several times in a row, the covariance is reset, at the present estimate.

    Args:
        spread: (P,) standard deviation of the start.
        threshold: nu^T S^-1 nu per row above which an innovation is improbable; infinite: never reset.
        samples: improbable innovations in a row that reset.

    Attributes:
        covariance_trace: of ``covariance``.
        resets: so far.
        surprise: nu^T S^-1 nu per row of the last update; 1 on average if the noise is as large as stated [-].

    Reference: Liu, Teng, Jin (2023), (39)-(41); Bierman, Factorization Methods for Discrete Sequential Estimation,
    1977, sec. II.3.
    """

    def __init__(self, spread: Vector, threshold: float, samples: int) -> None:
        self._spread, self._threshold, self._samples = spread, threshold, samples
        self.covariance_trace = 0.0
        self._restart()
        self._largest = MAX_GROWTH * self.covariance_trace
        self._memory = np.empty((2, spread.size))
        self.resets = 0
        self.surprise = 0.0

    @property
    def covariance(self) -> Vector:
        """(P, P) of the estimate, in units of the unit noise of the rows."""
        return self._root @ self._root.T

    @property
    def condition(self) -> float:
        """Largest over smallest eigenvalue of the covariance, each parameter in units of its first deviation [-].

        1 at the start; large where some combinations of parameters were excited and others were not.
        """
        values = np.linalg.svd(self._root / self._spread[:, None], compute_uv=False)
        return float((values[0] / values[-1]) ** 2) if values[-1] > 0.0 else inf

    def covariance_times(self, direction: Vector) -> Vector:
        """Return G d (P,) without forming G."""
        out = np.empty(direction.size)
        covariance_times(self._root, direction, self._memory[0], out)
        return out

    def correct(self, estimate: Vector, rows: Vector, values: Vector) -> tuple[Vector, Vector]:
        """Return the estimate (P,) after rows of unit noise, and the innovation (m,) they brought.

        Args:
            estimate: (P,) before.
            rows: (m, P) regressor, scaled to unit noise.
            values: (m,) measurements, scaled alike.

        Raises:
            ControlError: the covariance is no longer finite, or has blown up.
        """
        corrected, innovation = np.array(estimate), np.empty(values.size)
        surprise, self.covariance_trace, variances = correct(
            rows, values, self._root, corrected, innovation, self._memory
        )
        self.surprise = surprise / values.size
        self._check(variances)
        return corrected, innovation

    def _restart(self) -> None:
        self._root = np.diag(self._spread)
        self.covariance_trace = dot(self._spread, self._spread)
        self._improbable = 0

    def _check(self, variances: float) -> None:
        trace = float(self.covariance_trace)
        if not isfinite(variances + trace) or trace > self._largest:
            accepted = f"finite, below {self._largest:.3g}"
            raise ControlError("the covariance has blown up", key="covariance_trace", value=trace, accepted=accepted)
        self._improbable = self._improbable + 1 if self.surprise > self._threshold else 0
        if self._improbable >= self._samples:
            self._restart()
            self.resets += 1
