"""From distorted samples to a value and a rate: a constant-gain filter behind a gate."""

from __future__ import annotations

from math import exp

import numpy as np

from space_robot_msgs_py.interfaces import Vector


class GatedFilter:
    """Alpha-beta filter per channel; a sample that cannot be true is replaced by the prediction.

    The prediction is value + T rate. A sample is refused if it is not finite, or further from the prediction than the
    gate; after ``patience`` refusals in a row the next finite sample is accepted as it is, and the rate starts from
    zero, because then the prediction is wrong. The gains place both poles of the filter at exp(-bandwidth T)
    (critically damped g-h filter): g = 1 - p^2, h = (1 - p)^2.

    Args:
        period: T [s].
        bandwidth: of the filter [rad/s].
        gate: (m,) largest credible distance from the prediction, in the units of the samples; may be infinite.
        patience: refusals in a row before a channel restarts.

    Attributes:
        value: (m,) filtered.
        rate: (m,) per second.
        refused: (m,) number of samples refused so far.
        missing: (m,) True where the last sample was refused.
        sample: (m,) the last sample, or the prediction in its place.

    Reference: Bar-Shalom, Li, Kirubarajan, "Estimation with Applications to Tracking and Navigation", 2001, sec. 6.5.
    """

    def __init__(self, period: float, bandwidth: float, gate: Vector, patience: int) -> None:
        pole = exp(-bandwidth * period)
        self._period, self._gate, self._patience = period, np.array(gate), patience
        self._g, self._h = 1.0 - pole * pole, (1.0 - pole) ** 2 / period
        self.reset()

    def reset(self) -> None:
        """Forget the past; the next finite sample is accepted."""
        m = self._gate.size
        self.value, self.rate, self.sample = np.zeros(m), np.zeros(m), np.zeros(m)
        self.refused, self._in_a_row = np.zeros(m), np.full(m, np.inf)
        self.missing = np.zeros(m, dtype=bool)

    def update(self, sample: Vector, jump: Vector | None = None) -> None:
        """Take one sample per period.

        Args:
            sample: (m,) may hold numbers that are not finite.
            jump: (m,) by how much the quantity itself is known to have jumped since the last sample.
        """
        predicted = self.value + self._period * self.rate + (0.0 if jump is None else jump)
        finite = np.isfinite(sample)
        innovation = np.where(finite, sample, predicted) - predicted
        restart = finite & (self._in_a_row >= self._patience)
        taken = finite & ~restart & (np.abs(innovation) <= self._gate)
        self.missing = ~(taken | restart)
        self.sample = predicted + np.where(self.missing, 0.0, innovation)
        self.value = predicted + np.where(restart, innovation, np.where(taken, self._g * innovation, 0.0))
        self.rate = np.where(restart, 0.0, self.rate + np.where(taken, self._h * innovation, 0.0))
        # Before its first finite sample a channel has refused nothing, it has not begun.
        began = np.isfinite(self._in_a_row)
        self.refused = self.refused + (self.missing & began)
        self._in_a_row = np.where(self.missing, self._in_a_row + 1.0, 0.0)
