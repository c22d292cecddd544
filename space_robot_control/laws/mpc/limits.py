"""The limits of the actuators over a horizon, for what is added to a feed-forward: a box, and a slab per wheel."""

from __future__ import annotations

import numpy as np

from space_robot_control.command_limits import CommandLimits
from space_robot_control.laws.mpc.kernel.answer import LimitRule
from space_robot_description.robot import Robot
from space_robot_msgs_py.interfaces import Vector


class HorizonLimits:
    """rows z between bounds, z (N m,) the inputs of N periods in shares of ``effort``.

    Args:
        robot: the NOMINAL robot.
        effort: (m,) of the actuated degrees of freedom [N, N m].
        periods: N.

    Attributes:
        boxed: (k,) indices into a period's inputs that have a limit of their own.
        rule: of one period, for kernels.
        rows: (N w, N m) of the wheels, where torque about the axes of the body is shared by w of them.
    """

    def __init__(self, robot: Robot, effort: Vector, periods: int) -> None:
        first = 6 + robot.n - effort.size
        limits = CommandLimits(robot)
        self._periods, self._effort, self._first = periods, effort, first
        self._limit = limits.channels[: 6 + robot.n][first:]
        self.boxed = np.flatnonzero(np.isfinite(self._limit))
        self._share = np.zeros((limits.share.shape[0], effort.size))
        self._share[:, 3 - first : 6 - first] = limits.share
        self._wheel = limits.channels[6 + robot.n :]
        self.rule = LimitRule(np.array(self._limit), self._share, np.array(self._wheel))
        self.rows = np.array(np.kron(np.identity(periods), self._share * effort), dtype=np.float64)

    def bounds(self, feedforward: Vector) -> tuple[Vector, Vector, Vector, Vector]:
        """Lower and upper (N m,) of z, then lower and upper (N w,) of ``rows`` z.

        Args:
            feedforward: u (6+n,), taken as constant over the horizon [N, N m].
        """
        there = feedforward[self._first :]
        wheels = self._share @ there
        return (
            np.tile((-self._limit - there) / self._effort, self._periods),
            np.tile((self._limit - there) / self._effort, self._periods),
            np.tile(-self._wheel - wheels, self._periods),
            np.tile(self._wheel - wheels, self._periods),
        )
