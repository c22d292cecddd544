"""The linear model of a posture over a horizon, all states eliminated: what is left is a problem in the inputs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from space_robot_control.laws.lqr.kernel.design import DesignMemory
from space_robot_msgs_py.interfaces import Vector


@dataclass(frozen=True, eq=False, slots=True)
class Horizon:
    """The least of 1/2 z^T hessian z + (slope x)^T z, z = [w_0, .., w_{N-1}] in shares of the limits.

    It is the sum of |x_k|^2 + |w_k|^2 over N periods, and x_N^T X x_N of the regulator for all that come after.

    Attributes:
        hessian: (N m, N m).
        slope: (N m, 2m).
    """

    hessian: Vector
    slope: Vector


def make_horizon(design: DesignMemory, periods: int) -> Horizon:
    """The problem of a posture.

    Args:
        design: the regulator of the posture.
        periods: N.
    """
    size, m = design.b.shape
    # Stacked x_1 to x_N = phi x + gamma z.
    phi, gamma = np.empty((periods, size, size)), np.zeros((periods, size, periods, m))
    power = np.identity(size)
    for k in range(periods):
        effect = power @ design.b
        for row in range(k, periods):
            gamma[row, :, row - k] = effect
        power = design.a @ power
        phi[k] = power
    weighted = gamma.copy()
    weighted[-1] = np.tensordot(design.cost, gamma[-1], axes=1)
    flat = weighted.reshape(periods * size, periods * m)
    hessian = np.identity(periods * m) + flat.T @ gamma.reshape(periods * size, periods * m)
    hessian = 0.5 * (hessian + hessian.T)
    return Horizon(hessian, flat.T @ phi.reshape(periods * size, size))
