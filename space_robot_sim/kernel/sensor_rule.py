"""The channels of a sensor suite in numbers; no compiler is loaded for them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt


class SensorRule(NamedTuple):
    """The seven channels of a robot: position, attitude, joints, velocity, rate, joint rates, acceleration.

    Errors of the attitude are three numbers on four, so that a row of errors is one shorter than one of readings.

    Attributes:
        first: (8,) where the readings of each channel begin, and where the last one ends.
        ideal: (7,) 1: the channel shows the truth.
        delay: (7,) age of what it shows [periods].
        noise: (15+2n,) standard deviations.
        bias: (15+2n,) constant errors.
        quantum: (15+2n,) what readings are multiples of; 0: of nothing.
    """

    first: npt.NDArray[np.int64]
    ideal: npt.NDArray[np.int64]
    delay: npt.NDArray[np.int64]
    noise: npt.NDArray[np.float64]
    bias: npt.NDArray[np.float64]
    quantum: npt.NDArray[np.float64]
