"""Momentum of the reaction wheels: measured, or dead-reckoned from the commands."""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from typing import Any

import numpy as np

from space_robot_control.command_limits import CommandLimits
from space_robot_control.kernel.wheels import Wheels, apply_to_wheels
from space_robot_description.kernel.jit import bound
from space_robot_description.robot import Robot
from space_robot_description.rotations import cross
from space_robot_description.spec import ReactionWheels
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.products import times


class WheelMomentum:
    """Momentum h of the nominal wheels in the body frame.

    On a base that turns with omega the torque -omega x h acts beside the commanded one. Where a state has the measured
    momentum (``plant.sensors.wheel_momentum``), h is that. Where it has not, h is dead-reckoned, h' = -torque: the
    integral of the applied commands, of what the wheels can give of them, each within its torque, and none beyond its
    momentum; friction and faults of the wheels are not in that. Robots without wheels have h = 0.

    Args:
        robot: the NOMINAL robot.
        known: whether this is kept count of; where it is not h is 0, as without wheels.

    Attributes:
        present: whether there are wheels that are kept count of.
        numbers: the same for kernels, with the memory of all that changes.
        measured: (3,) h in the middle of the period that ended at the present stamp [N m s], and (3,) the torque on the
            base over it [N m], both from two readings; None: there are none.
    """

    def __init__(self, robot: Robot, *, known: bool = True) -> None:
        wheels = robot.actuators.base_torque
        self.present = known and isinstance(wheels, ReactionWheels)
        able = CommandLimits(robot).numbers
        count = able.share.shape[0] if self.present else 0
        capacity, initial = 0.0, np.zeros(count)
        if known and isinstance(wheels, ReactionWheels):
            capacity = wheels.momentum
            initial = (
                initial if wheels.initial_momentum is None else np.array(wheels.initial_momentum, dtype=np.float64)
            )
        self._initial = initial
        preserve = int(robot.actuators.saturation == "direction_preserving")
        self.numbers = Wheels(able, float(capacity), preserve, np.zeros(count), np.zeros(3), np.zeros(3))
        self.measured: tuple[Vector, Vector] | None = None
        self._read = False
        self._begun: tuple[Vector, float] | None = None
        self._refill()
        self._apply = _code(self.numbers, np.zeros(6 + robot.n), 0.0) if self.present else None

    @property
    def momentum(self) -> Vector:
        """(3,) h at the present stamp [N m s]."""
        return self.numbers.momentum.copy()

    @property
    def middle(self) -> Vector:
        """(3,) h in the middle of the period that ``apply`` was last called for [N m s]."""
        return self.numbers.middle.copy()

    def at_start(self) -> WheelMomentum:
        """The same wheels with the momentum they start a run with."""
        fresh = copy(self)
        fresh.numbers = self.numbers._replace(
            stored=np.zeros_like(self._initial), momentum=np.zeros(3), middle=np.zeros(3)
        )
        fresh.measured, fresh._read, fresh._begun = None, False, None
        fresh._refill()
        return fresh

    def measure(self, momentum: Vector | None) -> None:
        """Go on from a measured momentum (3,) [N m s]; None: there is none, and reckoning goes on.

        Of what the single wheels hold each changes as little as that takes; of three or fewer it is then known.
        """
        self._read = momentum is not None and self.present
        self.measured = None
        if momentum is None or not self.present:
            return
        self.numbers.stored[:] += times(self.numbers.able.share, momentum - self.numbers.momentum)
        self.numbers.momentum[:] = momentum
        if self._begun is not None:
            before, seconds = self._begun
            self.measured = 0.5 * (before + momentum), (before - momentum) / seconds

    def add_torque(self, u: Vector, omega: Vector) -> None:
        """Add omega x h to u (6+n,), what a base that turns at omega (3,) [rad/s] needs beside M a + c [N m]."""
        if self.present:
            u[3:6] += cross(omega.tolist(), self.numbers.momentum.tolist())

    def apply(self, u: Vector, seconds: float) -> None:
        """Integrate the command u (6+n,) [N, N m] that acts over a time [s]."""
        self._begun = (self.momentum, seconds) if self._read else None
        if self._apply is not None:
            self._apply(self.numbers, np.ascontiguousarray(u, dtype=np.float64), seconds)

    def _refill(self) -> None:
        self.numbers.stored[:] = self._initial
        if self.present:
            self.numbers.momentum[:] = times(self.numbers.able.axes, self._initial)


_found: list[Callable[..., None]] = []


def _code(*arguments: Any) -> Callable[..., None]:
    """The machine code, which is the same for all robots; to ask for it again takes time."""
    if not _found:
        _found.append(bound(apply_to_wheels, *arguments))
    return _found[0]
