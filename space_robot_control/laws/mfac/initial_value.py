"""The initial value Phi(1) from the first seconds (19)-(22): inputs that excite, and the fit of what the outputs do."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from space_robot_description.kernel.linear import least_squares
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.products import dot, times


@dataclass(frozen=True, eq=False, slots=True)
class Push:
    """All inputs at once, each towards its target: the beginning of a step response.

    Attributes:
        ticks: control periods.
        size: (m,) of the push.
    """

    ticks: int
    size: Vector

    def at(self, tick: int, error: Vector) -> Vector:
        """(m,) input at a tick; ``error`` (m,) is that of the first tick."""
        del tick
        return self.size * np.sign(error)


@dataclass(frozen=True, eq=False, slots=True)
class Pulses:
    """+, -, -, + on one input after the other: it ends at rest where it began.

    Attributes:
        quarter: control periods of one sign.
        size: (m,) of the pulses.
    """

    quarter: int
    size: Vector

    @property
    def ticks(self) -> int:
        """Control periods."""
        return 4 * self.quarter * self.size.size

    def at(self, tick: int, error: Vector) -> Vector:
        """(m,) input at a tick."""
        channel, phase = divmod(tick // self.quarter, 4)
        out = np.zeros(error.size)
        out[channel] = self.size[channel] * (1.0 if phase in (0, 3) else -1.0)
        return out


@dataclass(frozen=True, eq=False, slots=True)
class Response:
    """Acceleration of the outputs per input, y'' = B u.

    Attributes:
        gain: (m, m) B.
        deviation: (m, m) one standard deviation of each entry of B, from the residual of the fit and its correlation.
            It contains noise and misfit, not a systematic error, as of a grasp that slips under the push.
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

    Deviations from the paper: it takes the first sample, where noise makes the result useless; here all samples of the
    first seconds are taken and the result has a deviation.
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
        """Add the outputs at a tick and the inputs that act from it on, for one period."""
        self._rows.append(np.concatenate([[1.0, len(self._rows) * self._period], self._travel]))
        self._outputs.append(np.array(y))
        self._travel = self._travel + self._period * (self._speed + 0.5 * self._period * u)
        self._speed = self._speed + self._period * u

    def solve(self) -> Response:
        """Return B and its deviation; an entry that the samples do not determine has an infinite deviation."""
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
    """Coefficients and their standard deviations; what is not determined is 0 with an infinite deviation."""
    size = np.linalg.norm(rows, axis=0)
    freedom = rows.shape[0] - rows.shape[1]
    if freedom <= 0 or size.min() == 0.0 or np.linalg.cond(rows / size) > 1e8:
        return np.zeros(rows.shape[1]), np.full(rows.shape[1], np.inf)
    scaled = rows / size
    coefficients, inverse_normal = least_squares(scaled, y)
    residual = y - times(scaled, coefficients)
    variance = dot(residual, residual) / freedom
    # Correlated residuals count as fewer samples: a misfit is no white noise.
    correlation = dot(residual[1:], residual[:-1]) / max(dot(residual, residual), np.finfo(np.float64).tiny)
    correlation = min(max(correlation, 0.0), 0.99)
    variance *= (1.0 + correlation) / (1.0 - correlation)
    spread = np.sqrt(variance * inverse_normal)
    return coefficients / size, spread / size
