"""Dynamics of the NOMINAL robot, the model of all laws."""

from __future__ import annotations

from collections.abc import Callable
from math import isfinite
from typing import Any

import numpy as np
import pinocchio as pin

from space_robot_description.kernel.inverse_dynamics import MOTION_SIZE, inverse_dynamics
from space_robot_description.kernel.jit import bound
from space_robot_description.known_arrays import arrays_of
from space_robot_description.robot import Robot
from space_robot_msgs_py.errors import ControlError, SpecError
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.products import times


def not_finite(acceleration: Vector) -> ControlError:
    """What is said where the nominal model has no finite force for the acceleration a (6+n,) that a law asks for."""
    message = "inverse dynamics of the nominal model is not finite"
    return ControlError(message, key="a", value=acceleration.tolist())


class NominalModel:
    """M(q) a + c(q, v) = u in the coordinates of ``interfaces.py``; owns its work space.

    Inverse dynamics are those of ``kernel/inverse_dynamics.py``, which compiled laws call too: the same bits wherever
    a law runs. The mass matrix is Pinocchio's.

    u = [force(3), torque(3), efforts(n)] is dual to v = [linear(3), angular(3), rates(n)], base part in the body frame
    at the base origin. There is no gravity, so neither the base position nor its attitude enters.

    Args:
        robot: the NOMINAL robot.

    Attributes:
        arrays: the robot as kernels know it.
        mass: of the whole robot [kg].

    Raises:
        SpecError: the model is not a free-flyer with one-DoF joints, or has gravity.
    """

    def __init__(self, robot: Robot) -> None:
        model = robot.model
        if (model.nq, model.nv) != (7 + robot.n, 6 + robot.n) or np.any(model.gravity.vector):
            raise SpecError(
                "not a free-flying robot",
                key="robot.model",
                value=(model.nq, model.nv, model.gravity.vector.tolist()),
                accepted=f"nq = {7 + robot.n}, nv = {6 + robot.n}, no gravity",
            )
        self.robot = robot
        self.n = robot.n
        self.mass = float(pin.computeTotalMass(model))
        self._lower = np.tril_indices(6 + robot.n, -1)
        self._zero = np.zeros(6 + robot.n)
        self.arrays = arrays_of(model)
        self._work = np.zeros((len(self.arrays.links), MOTION_SIZE))
        q, out = np.zeros(7 + robot.n), np.zeros(6 + robot.n)
        self._inverse_dynamics = _code(self.arrays, q, out, out, self._work, out)

    def mass_matrix(self, q: Vector) -> Vector:
        """Return the symmetric (6+n, 6+n) M(q) [kg, kg m, kg m2].

        Args:
            q: (7+n,) configuration [m, -, rad].
        """
        m, (q, still) = np.empty((6 + self.n, 6 + self.n)), (np.array(q, dtype=np.float64, order="C"), self._zero)
        for row, unit in zip(m, np.identity(6 + self.n), strict=True):
            # Columns, which in a symmetric matrix are rows.
            self._inverse_dynamics(self.arrays, q, still, unit, self._work, row)
        m[self._lower] = m.T[self._lower]
        return m

    def reduced_mass_matrix(self, q: Vector) -> Vector:
        """Return the symmetric (3+n, 3+n) inertia of base rotation and joints while no force acts on the base [kg m2].

        Elimination of the translation, M_rr - M_rl M_lr / mass, since M_ll is the mass times the identity.

        Args:
            q: (7+n,) configuration [m, -, rad].
        """
        m = self.mass_matrix(q)
        out: Vector = m[3:, 3:] - times(m[3:, :3], m[:3, 3:]) / self.mass
        return out

    def actuated_mass_matrix(self, q: Vector) -> Vector:
        """Return M(q), or where no force acts on the base the reduced one, which has no rows of translation.

        Args:
            q: (7+n,) configuration [m, -, rad].
        """
        return self.reduced_mass_matrix(q) if self.robot.base_mode == "free_floating" else self.mass_matrix(q)

    def bias(self, q: Vector, v: Vector) -> Vector:
        """Return the (6+n,) Coriolis and centrifugal forces c(q, v) [N, N m].

        Args:
            q: (7+n,) configuration [m, -, rad].
            v: (6+n,) velocity, base twist in the body frame [m/s, rad/s].
        """
        return self.inverse_dynamics(q, v, self._zero)

    def inverse_dynamics(self, q: Vector, v: Vector, a: Vector) -> Vector:
        """Return the (6+n,) generalised force M(q) a + c(q, v) [N, N m].

        Args:
            q: (7+n,) configuration [m, -, rad].
            v: (6+n,) velocity, base twist in the body frame [m/s, rad/s].
            a: (6+n,) derivative of the components of v [m/s2, rad/s2].

        Raises:
            ControlError: the result is not finite.
        """
        u = np.empty(6 + self.n)
        # The machine code takes whatever it is given for numbers side by side.
        q, v, a = (np.ascontiguousarray(part, dtype=np.float64) for part in (q, v, a))
        self._inverse_dynamics(self.arrays, q, v, a, self._work, u)
        if not isfinite(u.sum()):
            raise not_finite(a)
        return u

    def free_floating_acceleration(self, q: Vector, v: Vector, a: Vector) -> Vector:
        """Return a with its first three entries replaced by those that need no force on the base.

        The zero-force rows are M_ll a_l + M_lr a_r + c_l = 0. In body-frame coordinates M_ll is the total mass times
        the identity, so with f = M [0, a_r] + c the solution is a_l = -f_l / mass.

        Args:
            q: (7+n,) configuration [m, -, rad].
            v: (6+n,) velocity, base twist in the body frame [m/s, rad/s].
            a: (6+n,) desired acceleration; its first three entries are ignored [m/s2, rad/s2].
        """
        out = np.array(a)
        out[:3] = 0.0
        out[:3] = self.inverse_dynamics(q, v, out)[:3] / -self.mass
        return out

    def actuated_inverse_dynamics(self, q: Vector, v: Vector, a: Vector) -> tuple[Vector, Vector]:
        """Return the force of the robot's actuators for a desired acceleration, and the acceleration it gives.

        Free-flying: (M a + c, a). Free-floating: the translation follows from zero force, see
        ``free_floating_acceleration``; the force entries of u are exactly zero.

        Args:
            q: (7+n,) configuration [m, -, rad].
            v: (6+n,) velocity, base twist in the body frame [m/s, rad/s].
            a: (6+n,) desired acceleration [m/s2, rad/s2].

        Returns:
            u (6+n,) [N, N m] and a (6+n,) [m/s2, rad/s2].
        """
        if self.robot.base_mode == "free_flying":
            return self.inverse_dynamics(q, v, a), a
        a = self.free_floating_acceleration(q, v, a)
        u = self.inverse_dynamics(q, v, a)
        u[:3] = 0.0
        return u, a


_found: list[Callable[..., None]] = []


def _code(*arguments: Any) -> Callable[..., None]:
    """The machine code of inverse dynamics, which is the same for all robots; to ask for it again takes time."""
    if not _found:
        _found.append(bound(inverse_dynamics, *arguments))
    return _found[0]
