"""The initial value of the data mapping model, from the first seconds of inputs and outputs (19)-(22)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from space_robot_msgs_py.interfaces import Vector


@dataclass(frozen=True, eq=False, slots=True)
class Response:
    """How the outputs accelerate under the inputs, y'' = B u.

    Attributes:
        gain: (m, m) B.
        deviation: (m, m) one standard deviation of each entry of B, from the residual of the fit and its correlation.
            It knows noise and what the samples contradict, not a body that answers as if it were lighter.
    """

    gain: Vector
    deviation: Vector

    @property
    def relative(self) -> Vector:
        """(m,) deviation of the diagonal over its size [-]."""
        size = np.abs(np.diag(self.gain))
        return np.diag(self.deviation) / np.where(size > 0.0, size, np.finfo(np.float64).tiny)


class ResponseFit:
    """Least squares of y(t) = y_0 + v_0 t + B s(t), where s'' = u exactly for an input held over each period.

    The offset and the initial rate are fitted with B, so neither needs to be known. ``diagonal``: every output is
    explained by its own input alone, the assumption (22) of the paper; else by all of them.

    Args:
        period: [s].
        outputs: m.
        diagonal: fit the diagonal of B only.

    Reference: Song et al. (2023), (19)-(22): M^-1 from inputs and outputs at the beginning.

    Deviations from the paper: it takes the first sample, where noise makes the result useless; this takes all samples
    of the first seconds and says how uncertain the result is.
    """

    def __init__(self, period: float, outputs: int, *, diagonal: bool) -> None:
        self._period, self._m, self._diagonal = period, outputs, diagonal
        self.reset()

    def reset(self) -> None:
        """Forget all samples."""
        self._travel, self._speed = np.zeros(self._m), np.zeros(self._m)
        self._rows: list[Vector] = []
        self._outputs: list[Vector] = []

    def add(self, y: Vector, u: Vector) -> None:
        """Take the outputs at a tick and the inputs that act from it on, for one period."""
        self._rows.append(np.concatenate([[1.0, len(self._rows) * self._period], self._travel]))
        self._outputs.append(np.array(y))
        self._travel = self._travel + self._period * (self._speed + 0.5 * self._period * u)
        self._speed = self._speed + self._period * u

    def solve(self) -> Response:
        """Return B and its deviation; an entry that the samples do not tell has an infinite deviation."""
        rows, y, m = np.array(self._rows), np.array(self._outputs), self._m
        gain, deviation = np.zeros((m, m)), np.full((m, m), np.inf)
        if self._diagonal:
            for i in range(m):
                coefficients, spread = _least_squares(rows[:, [0, 1, 2 + i]], y[:, i])
                gain[i, i], deviation[i, i] = coefficients[2], spread[2]
                deviation[i, [j for j in range(m) if j != i]] = 0.0
            return Response(gain, deviation)
        for i in range(m):
            coefficients, spread = _least_squares(rows, y[:, i])
            gain[i], deviation[i] = coefficients[2:], spread[2:]
        return Response(gain, deviation)


def _least_squares(rows: Vector, y: Vector) -> tuple[Vector, Vector]:
    """Coefficients and their standard deviations; what cannot be told apart is 0 with an infinite deviation."""
    size = np.linalg.norm(rows, axis=0)
    freedom = rows.shape[0] - rows.shape[1]
    if freedom <= 0 or size.min() == 0.0 or np.linalg.cond(rows / size) > 1e8:
        return np.zeros(rows.shape[1]), np.full(rows.shape[1], np.inf)
    scaled = rows / size
    coefficients = np.linalg.lstsq(scaled, y, rcond=None)[0]
    residual = y - scaled @ coefficients
    variance = float(residual @ residual) / freedom
    # Neighbouring residuals that are alike count as fewer samples: what the model misses is no white noise.
    alike = float(residual[1:] @ residual[:-1]) / max(float(residual @ residual), np.finfo(np.float64).tiny)
    alike = min(max(alike, 0.0), 0.99)
    variance *= (1.0 + alike) / (1.0 - alike)
    spread = np.sqrt(variance * np.diag(np.linalg.inv(scaled.T @ scaled)))
    return coefficients / size, spread / size
