"""The robot linearised at rest in a posture and sampled, in shares of what is accepted of errors and efforts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from space_robot_control.laws.lqr.riccati import solve_riccati
from space_robot_control.nominal_model import NominalModel
from space_robot_msgs_py.interfaces import Vector


@dataclass(frozen=True, eq=False, slots=True)
class Accepted:
    """Bryson's rule: what each number is divided by, so that one unit of each counts alike.

    Attributes:
        error: (m,) of the errors [m, rad, rad or m].
        rate: (m,) of their rates [m/s, rad/s, rad/s or m/s].
        effort: (m,) of the inputs [N, N m].
    """

    error: Vector
    rate: Vector
    effort: Vector


@dataclass(frozen=True, eq=False, slots=True)
class Design:
    """Regulator of a posture; x = [e / error, e' / rate], inputs in shares of ``effort``.

    Attributes:
        joints: (n,) posture it was made for [rad or m].
        a: (2m, 2m) x_{k+1} = a x_k + b w_k over a period in which w is held.
        b: (2m, m).
        cost: (2m, 2m) x^T cost x is what is still to come under ``gain``.
        gain: (m, 2m) w = -gain x.
    """

    joints: Vector
    a: Vector
    b: Vector
    cost: Vector
    gain: Vector

    @property
    def radius(self) -> float:
        """Largest magnitude of a pole of the sampled loop [-]."""
        return float(np.abs(np.linalg.eigvals(self.a - self.b @ self.gain)).max())


def make_design(model: NominalModel, q: Vector, control_period: float, accepted: Accepted) -> Design:
    """The regulator at rest in a configuration.

    Errors are desired minus actual: e'' = -M^-1 w, of the degrees of freedom that have an actuator.

    Args:
        model: the nominal model.
        q: (7+n,) configuration [m, -, rad].
        control_period: T [s].
        accepted: scales.

    Raises:
        ControlError: see ``solve_riccati``.
    """
    T, m = control_period, accepted.error.size
    response = np.linalg.inv(model.actuated_mass_matrix(q)) * accepted.effort
    a, b = np.identity(2 * m), np.empty((2 * m, m))
    a[:m, m:] = np.diag(T * accepted.rate / accepted.error)
    b[:m] = -0.5 * T * T * response / accepted.error[:, None]
    b[m:] = -T * response / accepted.rate[:, None]
    return Design(np.array(q[7:]), a, b, *solve_riccati(a, b))
