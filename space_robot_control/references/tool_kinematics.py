"""Pose of the tool, and the joints that bring it to a pose while the base moves on its own."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from space_robot_description.robot import Robot
from space_robot_description.rotations import Quaternion, conjugate, log, normalized, product, rotate
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Vector

TOLERANCE = 1e-11  # [m, rad]
ITERATIONS = 40
MAX_STEP = 0.3  # [rad] per iteration; a longer one leaves the branch of the solution before


@dataclass(frozen=True, eq=False, slots=True)
class Pose:
    """The tool frame in the inertial frame.

    Attributes:
        position: (3,) [m].
        quaternion: x, y, z, w.
    """

    position: Vector
    quaternion: Quaternion


def tool_pose(robot: Robot, q: Vector) -> Pose:
    """Return the pose of the robot's tool frame in a configuration (7+n,)."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    placement = data.oMf[robot.model.getFrameId(robot.tool_frame, pin.FrameType.BODY)]
    return Pose(np.array(placement.translation), normalized(pin.Quaternion(placement.rotation).coeffs().tolist()))


class ToolKinematics:
    """Generalised inverse kinematics: the base pose is given, or its position follows from the arm.

    Free-flying: the base motion is prescribed. Free-floating: nothing pushes the robot, so its centre of mass stays
    where it is and the base position is p = c0 - R c(joints); with the base rates given, the tool Jacobian of the
    joints is J_tool - J_com (inertial axes), the generalised Jacobian with the translation eliminated.

    Args:
        robot: the NOMINAL robot.
        initial_q: (7+n,) configuration whose centre of mass a free-floating robot keeps [m, -, rad].
        smallest_singular_value: see ``EndEffectorSpec``.

    Reference: Umetani and Yoshida, "Resolved motion rate control of space manipulators with generalized Jacobian
    matrix", IEEE T-RA 5(3), 1989.
    """

    def __init__(self, robot: Robot, initial_q: Vector, smallest_singular_value: float) -> None:
        self._robot, self._model, self._data = robot, robot.model, robot.model.createData()
        self._frame = robot.model.getFrameId(robot.tool_frame, pin.FrameType.BODY)
        self._floating, self._smallest = robot.base_mode == "free_floating", smallest_singular_value
        self._com = np.array(pin.centerOfMass(self._model, self._data, initial_q))

    def settled(self, q: Vector) -> Vector:
        """Return the configuration with the base position that a free-floating robot has in it."""
        if not self._floating:
            return q
        out = np.array(q)
        out[:3] += self._com - pin.centerOfMass(self._model, self._data, q)
        return out

    def solve(self, guess: Vector, target: Pose, *, orientation: bool, key: str, time: float) -> Vector:
        """Return the configuration near a guess whose tool is at the target; base attitude (and position) stay.

        Args:
            guess: (7+n,) [m, -, rad].
            target: of the tool.
            orientation: False: only the position counts.
            key: what to call the target in an error.
            time: for errors [s].

        Raises:
            SpecError: too few joints, out of reach, or closer to a singularity than allowed.
        """
        q, rows = self.settled(guess), 6 if orientation else 3
        if q.size - 7 < rows:
            accepted = "orientation: free" if orientation else "an arm of three joints or more"
            raise SpecError(f"{q.size - 7} joints cannot bring the tool there", key=key, accepted=accepted)
        for _ in range(ITERATIONS):
            error = self._error(q, target)[:rows]
            left, singular, right = np.linalg.svd(self._jacobian(q)[:rows], full_matrices=False)
            if singular[-1] < self._smallest:
                accepted = f"a tool Jacobian with singular values of {self._smallest:g} or more"
                raise SpecError(f"singular at {time:g} s", key=key, value=float(singular[-1]), accepted=accepted)
            if np.abs(error).max() < TOLERANCE:
                return q
            step = right.T @ ((left.T @ error) / singular)
            q = np.array(q)
            q[7:] += step * min(1.0, MAX_STEP / float(np.abs(step).max()))
            q = self.settled(q)
        away = f"{np.linalg.norm(error[:3]):.3g} m away"
        raise SpecError(f"out of reach at {time:g} s", key=key, value=away, accepted="a pose the arm can take")

    def rates(self, q: Vector, twist: Vector) -> tuple[Vector, Vector]:
        """Return the joint rates (n,) that move the tool while the base keeps its attitude, and the base's velocity.

        Arms of fewer than six joints follow the linear part alone. A free-floating base moves, the others rest.

        Args:
            q: (7+n,) configuration [m, -, rad].
            twist: (6,) of the tool in its own axes, linear then angular [m/s, rad/s].

        Raises:
            SpecError: too few joints, or closer to a singularity than allowed.
        """
        rows = 6 if q.size - 7 >= 6 else 3
        if q.size - 7 < rows:
            raise SpecError(f"{q.size - 7} joints cannot move the tool", key="teleop", accepted="three joints or more")
        attitude = tool_pose(self._robot, q).quaternion
        wanted = np.array((*rotate(attitude, twist[:3]), *rotate(attitude, twist[3:])))[:rows]
        left, singular, right = np.linalg.svd(self._jacobian(q)[:rows], full_matrices=False)
        if singular[-1] < self._smallest:
            accepted = f"singular values of {self._smallest:g} or more"
            raise SpecError("near a singularity", key="teleop", value=float(singular[-1]), accepted=accepted)
        rates: Vector = right.T @ ((left.T @ wanted) / singular)
        if not self._floating:
            return rates, np.zeros(3)
        return rates, -pin.jacobianCenterOfMass(self._model, self._data, q)[:, 6:] @ rates

    def _error(self, q: Vector, target: Pose) -> Vector:
        pose = tool_pose(self._robot, q)
        return np.concatenate(
            (target.position - pose.position, log(product(target.quaternion, conjugate(pose.quaternion))))
        )

    def _jacobian(self, q: Vector) -> Vector:
        jacobian = pin.computeFrameJacobian(self._model, self._data, q, self._frame, pin.LOCAL_WORLD_ALIGNED)
        out = np.array(jacobian[:, 6:])
        if self._floating:
            out[:3] -= pin.jacobianCenterOfMass(self._model, self._data, q)[:, 6:]
        return out
