"""From distorted samples to a value and a rate: a constant-gain filter behind a gate."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from space_robot_control.kernel.gated_filter import FilterRule, filter_memory, filter_samples, restart_filter
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.elementary import exp


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
        rule: the numbers, for kernels.
        memory: what it remembers, for kernels.

    Reference: Bar-Shalom, Li, Kirubarajan, "Estimation with Applications to Tracking and Navigation", 2001, sec. 6.5.
    """

    def __init__(self, period: float, bandwidth: float, gate: Vector, patience: int) -> None:
        self.rule, self.memory = filter_rule(period, bandwidth, gate, patience), filter_memory(len(gate))

    def reset(self) -> None:
        """Forget the past; the next finite sample is accepted."""
        restart_filter(self.memory)

    def update(self, sample: Vector, jump: Vector | None = None) -> None:
        """Take one sample per period.

        Args:
            sample: (m,) may hold numbers that are not finite.
            jump: (m,) by how much the quantity itself is known to have jumped since the last sample.
        """
        filter_samples(self.rule, self.memory, sample, np.zeros(sample.size) if jump is None else jump)

    @property
    def value(self) -> Vector:
        """(m,) filtered."""
        return self.memory.value

    @property
    def rate(self) -> Vector:
        """(m,) per second."""
        return self.memory.rate

    @property
    def refused(self) -> Vector:
        """(m,) number of samples refused so far."""
        return self.memory.refused

    @property
    def missing(self) -> npt.NDArray[np.bool_]:
        """(m,) True where the last sample was refused."""
        return self.memory.missing


def filter_rule(period: float, bandwidth: float, gate: Vector, patience: int) -> FilterRule:
    """The numbers of a ``GatedFilter``, from its arguments."""
    pole = exp(-bandwidth * period)
    limits = np.array(gate, dtype=np.float64)
    return FilterRule(period, 1.0 - pole * pole, (1.0 - pole) * (1.0 - pole) / period, patience, limits)
