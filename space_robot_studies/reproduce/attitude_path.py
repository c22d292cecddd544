"""How directly a base turned: its rotation axis against that of the shortest rotation, and the length of its path."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import numpy.typing as npt

from space_robot_description.rotations import log, relative, rotate
from space_robot_msgs_py.errors import NonFiniteError
from space_robot_msgs_py.interfaces import Vector

Matrix = npt.NDArray[np.float64]

# An axis is the direction of a rate: below this share of the largest rate it is noise.
TURNING = 0.01
MIN_ANGLE = 1e-6  # [rad]


def axis_distances(attitude: Matrix, omega: Matrix, goal: Vector) -> tuple[Vector, npt.NDArray[np.bool_]]:
    """Return the Euclidean distance (K,) of the instantaneous rotation axis to that of the geodesic, in [0, 2].

    The axis of the geodesic is the one about which the first attitude turns into the goal the short way; both are unit
    vectors in the inertial frame. What the paper shows in Fig. 1a.

    Args:
        attitude: (K, 4) quaternions x, y, z, w, body to inertial.
        omega: (K, 3) body rates [rad/s].
        goal: (4,) the attitude to reach.

    Returns:
        The distances, and where the body turns fast enough for an axis: above 1 % of its largest rate; elsewhere the
        distance is 0.

    Raises:
        NonFiniteError: nothing turns, or start and goal are one attitude: there is no axis to compare.

    Reference: [Giordano and Cenedese 2023, sec. V].
    """
    axis = np.array(rotate(attitude[0], log(relative(attitude[0], goal))))
    angle = float(np.linalg.norm(axis))
    rate = np.linalg.norm(omega, axis=1)
    if not (angle > MIN_ANGLE and float(rate.max()) > 0.0):
        raise NonFiniteError("no rotation to judge", key="attitude", value=angle, accepted="a start away from the goal")
    turning = rate > TURNING * rate.max()
    inertial = np.array([rotate(q, w) for q, w in zip(attitude, omega, strict=True)])
    distances = np.zeros(rate.size)
    distances[turning] = np.linalg.norm(inertial[turning] / rate[turning, None] - axis / angle, axis=1)
    return distances, turning


def path_ratios(attitude: Matrix, goal: Vector) -> Vector:
    """Return the length of the path so far (K,) over that of the geodesic from the first attitude to the goal [-].

    Args:
        attitude: (K, 4) quaternions, body to inertial.
        goal: (4,) the attitude to reach.

    Raises:
        NonFiniteError: start and goal are one attitude.
    """
    geodesic = float(np.linalg.norm(log(relative(attitude[0], goal))))
    if not geodesic > MIN_ANGLE:
        raise NonFiniteError("no path to judge", key="attitude", value=geodesic, accepted="a start away from the goal")
    steps = [float(np.linalg.norm(log(relative(a, b)))) for a, b in pairwise(attitude)]
    return np.concatenate(([0.0], np.cumsum(steps))) / geodesic
