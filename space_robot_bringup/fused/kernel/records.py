"""What a compiled run writes and follows, tick by tick."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt


class Records(NamedTuple):
    """Tick by tick, K of them, what a run leaves.

    Attributes:
        truth: (K, 16+2n) q, v and acceleration as they are.
        measured: (K, 16+2n) as they are read; (1, ...) where sensors are ideal.
        effort: (K, n) of the motors.
        plant: (K, ...) telemetry of the plant.
        law: (K, ...) telemetry of the law.
        command: (K, 6+n).
    """

    truth: npt.NDArray[np.float64]
    measured: npt.NDArray[np.float64]
    effort: npt.NDArray[np.float64]
    plant: npt.NDArray[np.float64]
    law: npt.NDArray[np.float64]
    command: npt.NDArray[np.float64]


class Desired(NamedTuple):
    """The reference of every tick: (K, 7+n), (K, 6+n), (K, 6+n)."""

    q: npt.NDArray[np.float64]
    v: npt.NDArray[np.float64]
    a: npt.NDArray[np.float64]
