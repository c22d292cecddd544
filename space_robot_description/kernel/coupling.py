"""Joints that share a coordinate: from the numbers of n coordinates to those of N joints.

A robot without followers has an empty table, and joint and coordinate are the same.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from space_robot_description.kernel.jit import constants, inner
from space_robot_msgs_py.interfaces import Vector

# Columns of a coupling, one row per joint: position = multiplier * that of the coordinate + offset.
COORDINATE, MULTIPLIER, OFFSET, COUPLING_SIZE = constants(0, 1, 2, 3)
# Factors of the offset: a position has it, a rate has not.
POSITION, RATE = 1.0, 0.0

NOTHING_COUPLED: npt.NDArray[np.float64] = np.zeros((0, 3))


def coupling_of(model: Any) -> npt.NDArray[np.float64]:
    """The (N, 3) table of a Pinocchio model with JointModelMimic; (0, 3) without."""
    joints = list(model.joints)[2:]
    if all(joint.nv for joint in joints):
        return NOTHING_COUPLED
    rows = []
    for joint in joints:
        own = (1.0, 0.0) if joint.nv else (joint.extract().scaling, joint.extract().offset)
        rows.append((joint.idx_v - 6, *own))
    return np.array(rows, dtype=np.float64)


@inner
def of_joint(coupling: Vector, values: Vector, first: int, joint: int, shift: float) -> float:
    """The number of a joint, of coordinates from entry ``first`` on; ``shift``: POSITION or RATE."""
    if coupling.shape[0]:
        value: float = values[first + int(coupling[joint, COORDINATE])]
        value = coupling[joint, MULTIPLIER] * value + shift * coupling[joint, OFFSET]
    else:
        value = values[first + joint]
    return value


@inner
def to_joints(coupling: Vector, x: Vector, shift: float, out: Vector) -> None:
    """Write (6+N,) of x (6+n,); only for robots with followers."""
    for i in range(6):
        out[i] = x[i]
    for joint in range(coupling.shape[0]):
        out[6 + joint] = of_joint(coupling, x, 6, joint, shift)
