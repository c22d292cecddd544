"""Momentum of the reaction wheels: measured, or dead-reckoned from the commands."""

from __future__ import annotations

from copy import copy

import numpy as np

from space_robot_control.command_limits import CommandLimits
from space_robot_description.robot import Robot
from space_robot_description.rotations import cross
from space_robot_description.spec import ReactionWheels
from space_robot_msgs_py.interfaces import Vector


class WheelMomentum:
    """Momentum h of the nominal wheels in the body frame.

    On a base that turns with omega the torque -omega x h acts beside the commanded one. Where a state has the measured
    momentum (``plant.sensors.wheel_momentum``), h is that. Where it has not, h is dead-reckoned, h' = -torque: the
    integral of the applied commands, of what the wheels can give of them, each within its torque, and none beyond its
    momentum; friction and faults of the wheels are not in that. Robots without wheels have h = 0.

    Args:
        robot: the NOMINAL robot.

    Attributes:
        present: whether there are wheels.
        momentum: (3,) h at the present stamp [N m s].
        middle: (3,) h in the middle of the period that ``apply`` was last called for [N m s].
        measured: (3,) h in the middle of the period that ended at the present stamp [N m s], and (3,) the torque on the
            base over it [N m], both from two readings; None: there are none.
    """

    def __init__(self, robot: Robot) -> None:
        wheels = robot.actuators.base_torque
        self.present = isinstance(wheels, ReactionWheels)
        self.momentum: Vector = np.zeros(3)
        self.middle: Vector = self.momentum
        self.measured: tuple[Vector, Vector] | None = None
        self._read = False
        self._begun: tuple[Vector, float] | None = None
        self._stored: list[float] = []
        if not isinstance(wheels, ReactionWheels):
            return
        self._limits, self._capacity, self._torque = CommandLimits(robot), wheels.momentum, wheels.torque
        self._preserve = robot.actuators.saturation == "direction_preserving"
        axes = np.ascontiguousarray(self._limits.axes.T)
        self._axes, self._taken = axes, -self._limits.share
        self._bounds = self._limits.channels.tolist()
        self._stored = [0.0] * len(axes)
        if wheels.initial_momentum is not None:
            stored = np.array(wheels.initial_momentum)
            self._stored, self.momentum = stored.tolist(), stored @ axes
        self._initial = self._stored, self.momentum

    def at_start(self) -> WheelMomentum:
        """The same wheels with the momentum they start a run with."""
        fresh = copy(self)
        if self.present:
            fresh._stored, fresh.momentum = self._initial
            fresh.middle = np.zeros(3)
            fresh.measured, fresh._read, fresh._begun = None, False, None
        return fresh

    def measure(self, momentum: Vector | None) -> None:
        """Go on from a measured momentum (3,) [N m s]; None: there is none, and reckoning goes on.

        Of what the single wheels hold each changes as little as that takes; of three or fewer it is then known.
        """
        self._read = momentum is not None and self.present
        self.measured = None
        if momentum is None or not self.present:
            return
        stored = np.array(self._stored) + self._limits.share @ (momentum - self.momentum)
        # A copy: the kernels are compiled for arrays that can be written to.
        self._stored, self.momentum = stored.tolist(), np.array(momentum)
        if self._begun is not None:
            before, seconds = self._begun
            self.measured = 0.5 * (before + momentum), (before - momentum) / seconds

    def add_torque(self, u: Vector, omega: Vector) -> None:
        """Add omega x h to u (6+n,), what a base that turns at omega (3,) [rad/s] needs beside M a + c [N m]."""
        if self.present:
            u[3:6] += cross(omega.tolist(), self.momentum.tolist())

    def apply(self, u: Vector, seconds: float) -> None:
        """Integrate the command u (6+n,) [N, N m] that acts over a time [s]."""
        if not self.present:
            return
        self._begun = (self.momentum, seconds) if self._read else None
        # On Python's floats, where the rounding is the same: of so few numbers several times faster than NumPy.
        torque = self._taken @ u[3:6]
        rates, capacity = torque.tolist(), self._capacity
        if all([abs(one) <= most for one, most in zip(u.tolist() + rates, self._bounds, strict=True)]):
            filled = [stored + seconds * rate for stored, rate in zip(self._stored, rates, strict=True)]
            if all([abs(one) <= capacity for one in filled]):
                # The same sum without the detour over the wheels: its rounding is part of every log.
                taken = 0.5 * seconds * u[3:6]
                self.middle = self.momentum - taken
                self._stored, self.momentum = filled, self.middle - taken
                return
        else:
            scale = self._limits.common_scale(u) if self._preserve else 1.0
            torque = np.clip(scale * torque, -self._torque, self._torque)
        stored = np.array(self._stored)
        self.middle = self._within(stored + 0.5 * seconds * torque) @ self._axes
        stored = self._within(stored + seconds * torque)
        self._stored, self.momentum = stored.tolist(), stored @ self._axes

    def _within(self, stored: Vector) -> Vector:
        return np.clip(stored, -self._capacity, self._capacity)
