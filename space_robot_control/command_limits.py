"""Limits of the nominal actuators, and two ways to bring a command within them."""

from __future__ import annotations

import numpy as np

from space_robot_control.kernel.actuators import Actuators
from space_robot_control.kernel.limits import fits
from space_robot_description.kernel.linear import least_norm
from space_robot_description.robot import Robot
from space_robot_description.spec import ReactionWheels
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.products import times


class CommandLimits:
    """The set of commands that no nominal actuator has to clip: a box, and with wheels a slab per wheel.

    The momentum that wheels hold and the pulses of thrusters are not in it: they are no property of a command alone.

    Args:
        robot: the NOMINAL robot.

    Attributes:
        numbers: all of them, for kernels.
        base: the same of the base alone, as ``kernel.limits.fits`` takes them.
        axes: (3, k) unit axes of the wheels, body frame; none without wheels.
        share: (k, 3) share of every wheel in a torque.
    """

    def __init__(self, robot: Robot) -> None:
        limit = np.full(6 + robot.n, np.inf)
        limit[6:] = robot.effort_limit
        if robot.actuators.base_force is not None:
            limit[:3] = robot.actuators.base_force.limit
        torque = robot.actuators.base_torque
        if isinstance(torque, ReactionWheels):
            axes = np.array(torque.axes).T
            self.axes = axes / np.linalg.norm(axes, axis=0)
            self.share = least_norm(self.axes)
            self._wheel_limit = torque.torque
        else:
            limit[3:6] = torque.limit
            self.axes, self.share, self._wheel_limit = np.zeros((3, 0)), np.zeros((0, 3)), 0.0
        self._limit = limit
        shares = self.share if self.share.size else np.identity(3)
        torques = np.full(shares.shape[0], self._wheel_limit) if self.share.size else limit[3:6].copy()
        force = np.zeros(3) if robot.actuators.base_force is None else limit[:3].copy()
        self.base = shares, torques, force
        self.numbers = Actuators(limit, np.ascontiguousarray(self.axes), self.share, float(self._wheel_limit))
        self._all = np.concatenate((limit, np.full(self.share.shape[0], self._wheel_limit)))

    @property
    def channels(self) -> Vector:
        """(6+n+wheels,) largest magnitude of every channel, then of every wheel's torque [N, N m]."""
        return self._all

    def fits(self, u: Vector) -> bool:
        """Return True if no channel and no wheel is beyond its limit.

        Args:
            u: (6+n,) command [N, N m].
        """
        return bool((np.abs(self._channels(u)) <= self._all).all())

    def base_fits(self, wrench: Vector) -> bool:
        """Return True if force and torque (6,) on the base are within the limits [N, N m]."""
        return fits(*self.base, wrench)

    def per_axis(self, u: Vector) -> Vector:
        """Return the command (6+n,) with every channel, and every wheel, clipped on its own [N, N m]."""
        out = np.clip(u, -self._limit, self._limit)
        if self.share.size:
            torque = times(self.axes, np.clip(times(self.share, out[3:6]), -self._wheel_limit, self._wheel_limit))
            # More than three wheels share the clipped torque again, and one may again be beyond its limit.
            largest = float(np.abs(times(self.share, torque)).max())
            out[3:6] = torque if largest <= self._wheel_limit else torque * (self._wheel_limit / largest)
        return out

    def direction_preserving(self, u: Vector, bias: Vector) -> Vector:
        """Return bias + alpha (u - bias) (6+n,) with the largest alpha in [0, 1] that fits [N, N m].

        The acceleration M^-1 (u - bias) keeps its direction, which a clip per channel does not: the joints' part of u
        counts on the base acceleration that the base's part was to give. Where bias itself is beyond a limit, alpha
        is 0 and the channels that still do not fit are clipped.

        Args:
            u: (6+n,) command [N, N m].
            bias: (6+n,) Coriolis and centrifugal forces [N, N m].
        """
        wanted, start = self._channels(u), self._channels(bias)
        beyond = np.abs(wanted) > self._all
        if not beyond.any():
            return u
        step, room = (wanted - start)[beyond], (np.copysign(self._all, wanted) - start)[beyond]
        # A channel beyond its limit without a step got there by bias alone.
        alphas = np.divide(room, step, out=np.zeros_like(step), where=step != 0.0)
        alpha = float(min(1.0, max(0.0, alphas.min())))
        # Clipped, because rounding may leave a channel a bit beyond its limit.
        return self.per_axis(bias + alpha * (u - bias))

    def _channels(self, u: Vector) -> Vector:
        return np.concatenate((u, times(self.share, u[3:6]))) if self.share.size else u
