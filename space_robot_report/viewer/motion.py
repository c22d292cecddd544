"""What is shown of a log at any time, also between its ticks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin

from space_robot_msgs_py.interfaces import Vector
from space_robot_report.playback import Footage


@dataclass(frozen=True, eq=False, slots=True)
class Moment:
    """One time of a run.

    Attributes:
        q: (7+n,) true configuration.
        q_d: (7+n,) desired configuration.
        torque: (3,) on the base, in its frame, over the largest of the run.
        efforts: (n,) of the joints, over the largest of the run.
    """

    q: Vector
    q_d: Vector
    torque: Vector
    efforts: Vector


class Motion:
    """A log as a function of time: configurations are interpolated, efforts hold until the next tick.

    Args:
        model: ``pin.Model`` of the robot.
        film: its log.
    """

    def __init__(self, model: Any, film: Footage) -> None:
        self._model, self.film = model, film

    def at(self, time: float) -> Moment:
        """What is shown at a time [s] of the run."""
        film = self.film
        last = film.time.size - 1
        row = min(max(int(np.searchsorted(film.time, time, side="right")) - 1, 0), last)
        after = min(row + 1, last)
        span = float(film.time[after] - film.time[row])
        share = min(max((time - float(film.time[row])) / span, 0.0), 1.0) if span else 0.0
        return Moment(
            q=pin.interpolate(self._model, film.q[row], film.q[after], share),
            q_d=pin.interpolate(self._model, film.q_d[row], film.q_d[after], share),
            torque=film.torque[row],
            efforts=film.efforts[row],
        )
