"""The linear separation: generalised forces as a regressor times the inertial parameters, in Euler coordinates."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin

from space_robot_description.inertia import inertial_parameters
from space_robot_description.kernel.coupling import COORDINATE, MULTIPLIER, OFFSET, coupling_of
from space_robot_description.kernel.joints import joint_axes
from space_robot_description.robot import Robot
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.products import times

PER_BODY = 10
_MASSLESS = 3  # of the four joints that carry the base the last one has its body


class Regressor:
    """Y with Y pi = generalised force, for the coordinates of ``euler_coordinates``; owns its work space.

    pi = (10 (1+N),) is [m, m c(3), Ixx, Ixy, Iyy, Ixz, Iyz, Izz] body after body, base first, the inertia about the
    joint origin in the body's joint frame (Pinocchio's order). Rows are [force inertial(3), torques about yaw, pitch,
    roll, joint efforts(n)]. With the base translation kept as three rows the equations are exactly linear in pi;
    neither position nor velocity of the base enters, only its inertial acceleration. Joints that follow others
    have no row: Y = G^T Y_N of all N joints, whose rates are G times those of the n coordinates.

    Polarisation gives the regressor of Slotine and Li from that of inverse dynamics, which is quadratic in velocity:
    Y(x, x', x_r', x_r'') = 1/4 [ Yp(x, x' + x_r', 2 x_r'') - Yp(x, x' - x_r', -2 x_r'') ]. It holds where the equations
    are Lagrange's, as here, and not for twists in the body frame.

    Args:
        robot: geometry, and the parameters to start from.

    Attributes:
        parameters: (10 (1+N),) of the robot, read only.

    Reference: Liu, Teng, Jin, Aerospace 10, 679, 2023, (29), (38), appendix A; Slotine and Li, IJRR 6(3), 1987.
    """

    def __init__(self, robot: Robot) -> None:
        self._model = _euler_model(robot)
        self._data = self._model.createData()
        self._coupling = coupling_of(robot.model)
        self._spread = _spread(self._coupling, robot.n)
        self._still = np.zeros(6 + robot.n)
        self._lower = np.tril_indices(6 + robot.n, -1)
        self.n = robot.n
        self.parameters: Vector = inertial_parameters(robot).ravel()
        self.parameters.flags.writeable = False

    def inverse_dynamics(self, x: Vector, dx: Vector, ddx: Vector) -> Vector:
        """Return Yp (6+n, 10 (1+N)) with Yp pi = M x'' + C x'.

        Args:
            x: (6+n,) Euler coordinates [m, rad].
            dx: (6+n,) [m/s, rad/s].
            ddx: (6+n,) [m/s2, rad/s2].
        """
        return self._rows(x, dx, ddx).copy()

    def slotine_li(self, x: Vector, dx: Vector, dx_r: Vector, ddx_r: Vector) -> Vector:
        """Return Y (6+n, 10 (1+N)) with Y pi = M x_r'' + C(x, x') x_r', C the Christoffel one.

        Args:
            x: (6+n,) Euler coordinates [m, rad].
            dx: (6+n,) [m/s, rad/s].
            dx_r: (6+n,) reference velocity [m/s, rad/s].
            ddx_r: (6+n,) reference acceleration [m/s2, rad/s2].
        """
        twice = 2.0 * ddx_r
        out = self._rows(x, dx + dx_r, twice).copy()
        out -= self._rows(x, dx - dx_r, -twice)
        out *= 0.25
        return out

    def inertia(self, x: Vector, a: Vector) -> Vector:
        """Return the regressor (6+n, 10 (1+N)) of M(x) a, without velocity."""
        return self.inverse_dynamics(x, self._still, a)

    def mass_matrix(self, x: Vector) -> Vector:
        """Return the symmetric (6+n, 6+n) M(x) of the robot this was made from [kg, kg m, kg m2].

        Args:
            x: (6+n,) Euler coordinates [m, rad].
        """
        if self._coupling.size:
            upper = np.triu(pin.crba(self._model, self._data, self._joints(x)))
            full: Vector = times(times(self._spread.T, upper + np.triu(upper, 1).T), self._spread)
            return full
        m = np.array(pin.crba(self._model, self._data, x))
        m[self._lower] = m.T[self._lower]
        return m

    def reduced_mass_matrix(self, x: Vector) -> Vector:
        """Return the symmetric (3+n, 3+n) inertia of rotation and joints while no force acts on the base [kg m2]."""
        m = self.mass_matrix(x)
        out: Vector = m[3:, 3:] - times(m[3:, :3], m[:3, 3:]) / m[0, 0]
        return out

    def _rows(self, x: Vector, dx: Vector, ddx: Vector) -> Vector:
        """A view of what Pinocchio overwrites at its next call."""
        if self._coupling.size:
            x, dx, ddx = self._joints(x), times(self._spread, dx), times(self._spread, ddx)
        full: Vector = pin.computeJointTorqueRegressor(self._model, self._data, x, dx, ddx)[:, _MASSLESS * PER_BODY :]
        return times(self._spread.T, full) if self._coupling.size else full

    def _joints(self, x: Vector) -> Vector:
        """(6+N,) of all joints."""
        out: Vector = times(self._spread, x)
        out[6:] += self._coupling[:, OFFSET]
        return out


def _spread(coupling: Vector, n: int) -> Vector:
    """G (6+N, 6+n): rates of all joints from those of the coordinates."""
    out = np.zeros((6 + len(coupling), 6 + n))
    out[:6, :6] = np.eye(6)
    for joint, row in enumerate(coupling, start=6):
        out[joint, 6 + int(row[COORDINATE])] = row[MULTIPLIER]
    return out


def _euler_model(robot: Robot) -> pin.Model:
    source, model, here = robot.model, pin.Model(), pin.SE3.Identity()
    model.gravity.setZero()
    base = 0
    for name, joint in (
        ("base_translation", pin.JointModelTranslation()),
        ("base_yaw", pin.JointModelRZ()),
        ("base_pitch", pin.JointModelRY()),
        ("base_roll", pin.JointModelRX()),
    ):
        base = model.addJoint(base, joint, here, name)
    model.appendBodyToJoint(base, source.inertias[1], here)
    for index in range(2, source.njoints):
        parent = source.parents[index] - 1 + base
        joint = source.joints[index]
        if not joint.nv:
            joint = _own_coordinate(source, index)
        added = model.addJoint(parent, joint, source.jointPlacements[index], source.names[index])
        model.appendBodyToJoint(added, source.inertias[index], here)
    return model


def _own_coordinate(model: Any, index: int) -> Any:
    """A follower as a joint that follows none."""
    axes, slides = joint_axes(model)
    axis = axes[index - 2]
    return pin.JointModelPrismaticUnaligned(axis) if slides[index - 2] else pin.JointModelRevoluteUnaligned(axis)
