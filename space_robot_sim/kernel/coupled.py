"""Forward dynamics of a tree of which joints follow others: the mass matrix of the coordinates, and its solution.

q_N = G q + g and v_N = G v give M = G^T M_N G and c = G^T c_N: inverse dynamics in the coordinates, which the kernel
does, has both, column by column. The articulated-body algorithm has no place for a joint that another one moves.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from space_robot_description.kernel.arrays import LOCKED, RobotArrays
from space_robot_description.kernel.coupling import COORDINATE
from space_robot_description.kernel.inverse_dynamics import MOTION_SIZE, inverse_dynamics
from space_robot_description.kernel.jit import inner, kernel
from space_robot_description.kernel.spatial import Vec
from space_robot_msgs_py.interfaces import Vector


class CoupledMemory(NamedTuple):
    """Scratch; empty for robots without followers.

    Attributes:
        motion: (1+N, MOTION_SIZE).
        mass: (6+n, 6+n) mass matrix, then its factors.
        unit: (6+n,) zeros but for one acceleration at a time.
        rest: (6+n,) zeros.
        force: (6+n,) applied less bias, then the accelerations.
    """

    motion: npt.NDArray[np.float64]
    mass: npt.NDArray[np.float64]
    unit: npt.NDArray[np.float64]
    rest: npt.NDArray[np.float64]
    force: npt.NDArray[np.float64]


def coupled_memory(joints: int, followers: int) -> CoupledMemory:
    """Memory for a robot with that many joints, and others that follow them."""
    size, bodies = (6 + joints, 1 + joints + followers) if followers else (0, 0)
    vectors = np.zeros(size), np.zeros(size), np.zeros(size)
    return CoupledMemory(np.zeros((bodies, MOTION_SIZE)), np.zeros((size, size)), *vectors)


@kernel
def coupled_dynamics(
    robot: RobotArrays, y: Vector, force: Vec, torque: Vec, effort: Vector, work: CoupledMemory, dy: Vector
) -> None:
    """Accelerations of the base and the coordinates under applied forces; see ``forward_dynamics``.

    Args:
        robot: the robot, with followers.
        y: state [position(3), quaternion(4), joints(n), linear(3), angular(3), rates(n), ...], twist in the body frame.
        force: force on the base, body frame [N].
        torque: moment on the base about its origin, body frame [N m].
        effort: (n,) joint efforts [N m or N].
        work: scratch.
        dy: receives d/dt of [linear, angular, rates] at the places of those in y.
    """
    n = effort.shape[0]
    q = y[: 7 + n]
    inverse_dynamics(robot, q, y[7 + n : 13 + 2 * n], work.rest, work.motion, work.force)
    for i in range(6 + n):
        work.unit[i] = 1.0
        inverse_dynamics(robot, q, work.rest, work.unit, work.motion, work.mass[i])
        work.unit[i] = 0.0
        work.force[i] = -work.force[i]
    for k in range(3):
        work.force[k] += force[k]
        work.force[3 + k] += torque[k]
    for joint in range(n):
        work.force[6 + joint] += effort[joint]
    _hold(robot, work)
    _solve(work.mass, work.force)
    for i in range(6 + n):
        dy[7 + n + i] = work.force[i]


@inner
def _hold(robot: RobotArrays, work: CoupledMemory) -> None:
    """Coordinates that a brake holds do not accelerate."""
    for joint in range(robot.coupling.shape[0]):
        if robot.tree[1 + joint, LOCKED]:
            row = 6 + int(robot.coupling[joint, COORDINATE])
            for i in range(work.force.shape[0]):
                work.mass[row, i] = 0.0
                work.mass[i, row] = 0.0
            work.mass[row, row], work.force[row] = 1.0, 0.0


@inner
def _solve(m: Vector, b: Vector) -> None:
    """Put M^-1 b into b, M positive definite: L L^T into the lower part of m (Cholesky), then forward and back."""
    size = b.shape[0]
    for j in range(size):
        for i in range(j, size):
            total = m[i, j]
            for k in range(j):
                total -= m[i, k] * m[j, k]
            # A matrix that is not positive definite gives what is not a number, which ends the run.
            m[i, j] = sqrt(total) if i == j else total / m[j, j]
    for i in range(size):
        for k in range(i):
            b[i] -= m[i, k] * b[k]
        b[i] /= m[i, i]
    for i in range(size - 1, -1, -1):
        for k in range(i + 1, size):
            b[i] -= m[k, i] * b[k]
        b[i] /= m[i, i]
