"""Time-delay estimation of the acceleration that the nominal model did not explain in the last period."""

from __future__ import annotations

import numpy as np

from space_robot_msgs_py.interfaces import Vector


class DisturbanceObserver:
    """d <- d + share ((v_k - v_{k-1}) / T - a_{k-1} - d), a what the last command causes in the nominal model.

    With an inertia M the residual is (M^-1 M0 - I) a: the loop through d contracts only while M0 is near M, so that a
    roughly known payload is compensated and an unknown one of the arm's own mass makes it diverge.

    Args:
        share: of the newest residual, in [0, 1]; 0: the estimate stays zero.
        control_period: T [s].
        size: 6+n.

    Reference: Youcef-Toumi and Ito, "A time delay controller for systems with unknown dynamics", ASME JDSMC 112, 1990.
    """

    def __init__(self, share: float, control_period: float, size: int) -> None:
        self._share, self._period, self._size = share, control_period, size
        self.reset()

    def reset(self) -> None:
        """Forget the past."""
        self._estimate = np.zeros(self._size)
        self._velocity: Vector | None = None
        self._expected: Vector | None = None

    def update(self, velocity: Vector) -> Vector:
        """Return the estimate (6+n,) [m/s2, rad/s2] after a measured v (6+n,) [m/s, rad/s]."""
        if self._share and self._velocity is not None and self._expected is not None:
            residual = (velocity - self._velocity) / self._period - self._expected
            self._estimate = self._estimate + self._share * (residual - self._estimate)
        self._velocity = velocity
        return self._estimate

    def expect(self, acceleration: Vector | None) -> None:
        """Take the dv/dt (6+n,) that the command causes in the nominal model [m/s2, rad/s2]; None: not known."""
        self._expected = acceleration
