"""A robot as three arrays, so that one compiled kernel serves every robot.

Every joint frame is turned so that the joint moves along or about its z axis; the base frame is left as it is.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from space_robot_description.kernel.coupling import COORDINATE, NOTHING_COUPLED, coupling_of
from space_robot_description.kernel.jit import constants
from space_robot_description.kernel.joints import joint_axes
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.products import dot, norm, times

# Columns of `links`: rotation to the parent (9), origin in the parent (3), mass, mass * com (3), inertia at origin (6).
ROTATION, ORIGIN, MASS, MOMENT, INERTIA, LINK_SIZE = constants(0, 9, 12, 13, 16, 22)
PARENT, PRISMATIC, LOCKED, TREE_SIZE = constants(0, 1, 2, 3)
(BASE,) = constants(0)


class RobotArrays(NamedTuple):
    """The numbers of a free-flying tree of 1 + N bodies, moved by n coordinates; N = n where no joint follows another.

    Attributes:
        tree: (1+N, 3) parent body, 1 where the joint slides, 1 where a brake holds it; row 0 is the base.
        links: (1+N, 22) geometry and inertia in canonical frames [m, kg, kg m, kg m2].
        motors: (n, 4) lag [s], viscous [N m s/rad], Coulomb [N m], Coulomb velocity [rad/s].
        coupling: (N, 3) which coordinate moves each joint, see ``kernel.coupling``; (0, 3) where N = n.
    """

    tree: npt.NDArray[np.int64]
    links: npt.NDArray[np.float64]
    motors: npt.NDArray[np.float64]
    coupling: npt.NDArray[np.float64] = NOTHING_COUPLED


def robot_arrays(model: Any, motors: npt.ArrayLike | None = None) -> RobotArrays:
    """Canonical arrays of a Pinocchio model.

    Args:
        model: free-flyer root, then joints with one degree of freedom each or JointModelMimic, no gravity, no armature.
        motors: (n, 4) as in RobotArrays; None: ideal motors.

    Raises:
        SpecError: the model is not such a robot.
    """
    axes, slides = joint_axes(model)
    bodies = model.njoints - 1
    tree = np.zeros((bodies, TREE_SIZE), dtype=np.int64)
    links = np.zeros((bodies, LINK_SIZE))
    turns = [np.eye(3)]
    for body in range(bodies):
        if body:
            tree[body] = model.parents[body + 1] - 1, slides[body - 1], 0
            turns.append(_frame_along(axes[body - 1]))
            placement, parent_turn = model.jointPlacements[body + 1], turns[tree[body, PARENT]]
            links[body, ROTATION:ORIGIN] = times(times(parent_turn.T, placement.rotation), turns[body]).ravel()
            links[body, ORIGIN:MASS] = times(parent_turn.T, placement.translation)
        links[body, MASS:] = _inertia(model.inertias[body + 1], turns[body])
    ideal = np.tile([0.0, 0.0, 0.0, 1.0], (model.nv - 6, 1))
    rows = ideal if motors is None else np.ascontiguousarray(motors, dtype=np.float64)
    return RobotArrays(tree, links, rows, coupling_of(model))


def locked_joints(robot: RobotArrays) -> npt.NDArray[np.bool_]:
    """(n,) coordinates that a brake holds."""
    locked = robot.tree[1:, LOCKED] > 0
    if robot.coupling.shape[0]:
        _, first = np.unique(robot.coupling[:, COORDINATE], return_index=True)
        locked = locked[first]
    return locked


def with_locked_joints(robot: RobotArrays, locked: npt.NDArray[Any]) -> RobotArrays:
    """The robot with brakes that hold these coordinates (n,), not zero where one does."""
    tree = robot.tree.copy()
    tree[1:, LOCKED] = locked[robot.coupling[:, COORDINATE].astype(int)] if robot.coupling.shape[0] else locked
    return robot._replace(tree=tree)


def _frame_along(axis: Vector) -> npt.NDArray[np.float64]:
    """A rotation whose z axis is the given unit vector."""
    axis = axis / norm(axis)
    x = np.cross(np.eye(3)[np.argmin(np.abs(axis))], axis)
    x /= norm(x)
    return np.column_stack([x, np.cross(axis, x), axis])


def _inertia(inertia: Any, turn: npt.NDArray[np.float64]) -> Vector:
    """Mass, first moment and inertia at the origin, in the turned frame."""
    com = times(turn.T, inertia.lever)
    spread = dot(com, com) * np.eye(3) - np.outer(com, com)
    at_origin = times(times(turn.T, inertia.inertia), turn) + inertia.mass * spread
    return np.concatenate([[inertia.mass], inertia.mass * com, at_origin[np.triu_indices(3)]])
