"""Pose of the tool, and the joints that bring it to a pose while the base moves on its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from space_robot_description.kernel.linear import solve
from space_robot_description.robot import Robot
from space_robot_description.rotations import Quaternion, conjugate, log, normalized, product, rotate
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.products import times

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


class Aim(NamedTuple):
    """Where a tool is to be.

    Attributes:
        link: of the robot.
        pose: of it.
        orientation: False: only the position counts.
    """

    link: str
    pose: Pose
    orientation: bool = True

    @property
    def rows(self) -> int:
        """Numbers that it prescribes."""
        return 6 if self.orientation else 3


def tool_pose(robot: Robot, q: Vector, link: str = "") -> Pose:
    """Return the pose of a link, by default the robot's tool frame, in a configuration (7+n,)."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    placement = data.oMf[robot.model.getFrameId(link or robot.tool_frame, pin.FrameType.BODY)]
    return Pose(np.array(placement.translation), normalized(pin.Quaternion(placement.rotation).coeffs().tolist()))


class ToolKinematics:
    """Generalised inverse kinematics: the base pose is given, or its position follows from the arm.

    Free-flying: the base motion is prescribed. Free-floating: nothing pushes the robot, so its centre of mass stays
    where it is and the base position is p = c0 - R c(joints); with the base rates given, the tool Jacobian of the
    joints is J_tool - J_com (inertial axes), the generalised Jacobian with the translation eliminated. Of a robot with
    several arms the joints between the base and the tools in question move, and the others rest.

    Args:
        robot: the NOMINAL robot.
        initial_q: (7+n,) configuration whose centre of mass a free-floating robot keeps [m, -, rad].
        smallest_singular_value: see ``EndEffectorSpec``.

    Reference: Umetani and Yoshida, "Resolved motion rate control of space manipulators with generalized Jacobian
    matrix", IEEE T-RA 5(3), 1989.
    """

    def __init__(self, robot: Robot, initial_q: Vector, smallest_singular_value: float) -> None:
        self._robot, self._model, self._data = robot, robot.model, robot.model.createData()
        self._floating, self._smallest = robot.base_mode == "free_floating", smallest_singular_value
        self._com = np.array(pin.centerOfMass(self._model, self._data, initial_q))

    def settled(self, q: Vector) -> Vector:
        """Return the configuration with the base position that a free-floating robot has in it."""
        if not self._floating:
            return q
        out = np.array(q)
        out[:3] += self._com - pin.centerOfMass(self._model, self._data, q)
        return out

    def solve(self, guess: Vector, aims: Sequence[Aim], *, key: str, time: float) -> Vector:
        """Return the configuration near a guess whose tools are where they aim; base attitude (and position) stay.

        Args:
            guess: (7+n,) [m, -, rad].
            aims: of different tools.
            key: what to call the target in an error.
            time: for errors [s].

        Raises:
            SpecError: too few joints, out of reach, or closer to a singularity than allowed.
        """
        q, joints = self.settled(guess), self._joints([aim.link for aim in aims])
        if joints.size < sum(aim.rows for aim in aims):
            accepted = "orientation: free" if aims[0].orientation else "an arm of three joints or more"
            raise SpecError(f"{joints.size} joints cannot bring the tool there", key=key, accepted=accepted)
        for _ in range(ITERATIONS):
            error = np.concatenate([self._error(q, aim)[: aim.rows] for aim in aims])
            jacobian = np.vstack([self._jacobian(q, aim.link)[: aim.rows, joints] for aim in aims])
            singular = np.linalg.svd(jacobian, compute_uv=False)
            if singular[-1] < self._smallest:
                accepted = f"a tool Jacobian with singular values of {self._smallest:g} or more"
                raise SpecError(f"singular at {time:g} s", key=key, value=float(singular[-1]), accepted=accepted)
            if np.abs(error).max() < TOLERANCE:
                return q
            step = times(jacobian.T, solve(times(jacobian, jacobian.T), error))
            q = np.array(q)
            q[7 + joints] += step * min(1.0, MAX_STEP / float(np.abs(step).max()))
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
        joints = self._joints([self._robot.tool_frame])
        rows = 6 if joints.size >= 6 else 3
        if joints.size < rows:
            raise SpecError(f"{joints.size} joints cannot move the tool", key="teleop", accepted="three joints or more")
        attitude = tool_pose(self._robot, q).quaternion
        wanted = np.array((*rotate(attitude, twist[:3]), *rotate(attitude, twist[3:])))[:rows]
        jacobian = self._jacobian(q, self._robot.tool_frame)[:rows, joints]
        singular = np.linalg.svd(jacobian, compute_uv=False)
        if singular[-1] < self._smallest:
            accepted = f"singular values of {self._smallest:g} or more"
            raise SpecError("near a singularity", key="teleop", value=float(singular[-1]), accepted=accepted)
        rates = np.zeros(q.size - 7)
        rates[joints] = times(jacobian.T, solve(times(jacobian, jacobian.T), wanted))
        if not self._floating:
            return rates, np.zeros(3)
        return rates, -times(pin.jacobianCenterOfMass(self._model, self._data, q)[:, 6:], rates)

    def _joints(self, links: Sequence[str]) -> npt.NDArray[np.int64]:
        """Indices of the joints that may move for these tools."""
        if not self._robot.tools:
            return np.arange(self._robot.n)
        carried = [self._model.frames[self._model.getFrameId(link, pin.FrameType.BODY)].parentJoint for link in links]
        chains = {joint for one in carried for joint in self._model.supports[one] if joint > 1}
        return np.unique([self._model.joints[joint].idx_v - 6 for joint in chains])

    def _error(self, q: Vector, aim: Aim) -> Vector:
        pose, target = tool_pose(self._robot, q, aim.link), aim.pose
        return np.concatenate(
            (target.position - pose.position, log(product(target.quaternion, conjugate(pose.quaternion))))
        )

    def _jacobian(self, q: Vector, link: str) -> Vector:
        frame = self._model.getFrameId(link, pin.FrameType.BODY)
        jacobian = pin.computeFrameJacobian(self._model, self._data, q, frame, pin.LOCAL_WORLD_ALIGNED)
        out = np.array(jacobian[:, 6:])
        if self._floating:
            out[:3] -= pin.jacobianCenterOfMass(self._model, self._data, q)[:, 6:]
        return out
