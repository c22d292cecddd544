"""A robot as three arrays, so that one compiled kernel serves every robot.

Every joint frame is turned so that the joint moves along or about its z axis; the base frame is left as it is.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from space_robot_description.kernel.jit import constants
from space_robot_description.kernel.joints import joint_axes
from space_robot_msgs_py.interfaces import Vector

# Columns of `links`: rotation to the parent (9), origin in the parent (3), mass, mass * com (3), inertia at origin (6).
ROTATION, ORIGIN, MASS, MOMENT, INERTIA, LINK_SIZE = constants(0, 9, 12, 13, 16, 22)
PARENT, PRISMATIC, LOCKED, TREE_SIZE = constants(0, 1, 2, 3)
(BASE,) = constants(0)


class RobotArrays(NamedTuple):
    """The numbers of a free-flying tree of 1 + n bodies.

    Attributes:
        tree: (1+n, 3) parent body, 1 where the joint slides, 1 where a brake holds it; row 0 is the base.
        links: (1+n, 22) geometry and inertia in canonical frames [m, kg, kg m, kg m2].
        motors: (n, 4) lag [s], viscous [N m s/rad], Coulomb [N m], Coulomb velocity [rad/s].
    """

    tree: npt.NDArray[np.int64]
    links: npt.NDArray[np.float64]
    motors: npt.NDArray[np.float64]


def robot_arrays(model: Any, motors: npt.ArrayLike | None = None) -> RobotArrays:
    """Canonical arrays of a Pinocchio model.

    Args:
        model: free-flyer root, then joints with one degree of freedom each, no gravity, no armature.
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
            links[body, ROTATION:ORIGIN] = (parent_turn.T @ placement.rotation @ turns[body]).ravel()
            links[body, ORIGIN:MASS] = parent_turn.T @ placement.translation
        links[body, MASS:] = _inertia(model.inertias[body + 1], turns[body])
    ideal = np.tile([0.0, 0.0, 0.0, 1.0], (bodies - 1, 1))
    return RobotArrays(tree, links, ideal if motors is None else np.ascontiguousarray(motors, dtype=np.float64))


def _frame_along(axis: Vector) -> npt.NDArray[np.float64]:
    """A rotation whose z axis is the given unit vector."""
    axis = axis / np.linalg.norm(axis)
    x = np.cross(np.eye(3)[np.argmin(np.abs(axis))], axis)
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(axis, x), axis])


def _inertia(inertia: Any, turn: npt.NDArray[np.float64]) -> Vector:
    """Mass, first moment and inertia at the origin, in the turned frame."""
    com = turn.T @ inertia.lever
    spread = float(com @ com) * np.eye(3) - np.outer(com, com)
    at_origin = turn.T @ inertia.inertia @ turn + inertia.mass * spread
    return np.concatenate([[inertia.mass], inertia.mass * com, at_origin[np.triu_indices(3)]])
