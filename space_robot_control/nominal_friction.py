"""Friction of the nominal robot's joints, which the equations of laws have not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from space_robot_description.robot import Robot
from space_robot_description.spec import expand
from space_robot_msgs_py.interfaces import Reference, RobotState, Vector
from space_robot_msgs_py.kernel.elementary import tanh


class NominalFriction:
    """f(r) = b r + c tanh(r / v0) of every joint, added to the efforts that a law asks for.

    b, c and v0 are the nominal robot's (``actuators.joints``), r the desired rates: a feed-forward, which no error of
    the friction can make unstable, and which does nothing where the reference stands still. Measured rates would cancel
    friction there too, but a light joint, whose friction acts faster than a period, would then coast on.

    Args:
        robot: the NOMINAL robot.
        known: whether laws know its friction, ``robot.knows_friction`` for those that follow the reference.

    Attributes:
        known: whether anything is added.

    Reference: Siciliano et al., "Robotics: Modelling, Planning and Control", 2009, sec. 7.2.1 (F_v and F_s), sec. 8.5.
    """

    def __init__(self, robot: Robot, known: bool) -> None:
        motors, names = robot.actuators.joints, robot.joint_names
        zero = [0.0] * robot.n
        self._viscous, self._coulomb = (
            expand(getattr(motors, key), names, f"actuators.joints.{key}", zero) for key in ("viscous", "coulomb")
        )
        self._velocity = motors.coulomb_velocity
        self.known = known

    def effort(self, rates: Vector) -> Vector:
        """Return f (n,) [N m or N] at joint rates (n,) [rad/s or m/s]."""
        smooth = np.array([tanh(rate) for rate in (rates / self._velocity).tolist()])
        out: Vector = self._viscous * rates + self._coulomb * smooth
        return out

    def added(self, u: Vector, reference: Reference) -> Vector:
        """Return u (6+n,) [N, N m] with f in its efforts; what has another shape is returned as it is.

        Args:
            u: what the equation of the law says.
            reference: of the same stamp.
        """
        if not self.known or np.shape(u) != reference.v.shape:
            return u
        out = np.array(u, dtype=np.float64)
        out[6:] += self.effort(reference.v[6:])
        return out

    def without(self, state: RobotState, rates: Vector) -> RobotState:
        """Return the state with the efforts that moved the joints over the period before it, friction taken off.

        Args:
            state: measured.
            rates: (n,) of the joints where the period began [rad/s or m/s].
        """
        if not self.known:
            return state
        lost = 0.5 * (self.effort(rates) + self.effort(state.joint_rates))
        return replace(state, effort=state.effort - lost)
