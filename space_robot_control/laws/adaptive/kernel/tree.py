"""A robot in Euler coordinates as three arrays, and where its bodies and axes are.

The degrees of freedom are those of ``kernel.euler``: three translations and three rotations of the base, then the
joints. Everything is expressed in inertial axes and placed from the origin of the base, because neither the position
nor the velocity of the base enters the equations of motion.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from space_robot_description.kernel.coupling import NOTHING_COUPLED, POSITION, coupling_of, to_joints
from space_robot_description.kernel.jit import constants, inner
from space_robot_description.kernel.joints import joint_axes
from space_robot_description.kernel.spatial import Mat, Vec, add, get3, get9, mul, product, put3, put9, scaled
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.elementary import sincos

BASE = 6  # degrees of freedom before the first joint
# Columns of `frames`: rotation to the parent (9), origin in the parent (3), axis of the joint in its own frame (3).
ROTATION, ORIGIN, AXIS = constants(0, 9, 12)
# Columns of `bodies`: rotation to inertial axes (9), origin (3); the rest belongs to `kernel.motion`.
TURN, PLACE = constants(0, 9)
# Columns of `axes`: direction (3), a point on it (3).
ALONG, THROUGH = constants(0, 3)
(ROOT,) = constants(0)


class Tree(NamedTuple):
    """The geometry of 1 + N bodies, each in Pinocchio's joint frame; n coordinates move N joints.

    Attributes:
        parent: (1+N,) body that carries each body; 0 for the base.
        slides: (6+N,) 1 where a degree of freedom is a translation.
        frames: (1+N, 15) placements and joint axes [m].
        coupling: (N, 3) of joints that follow others, see ``description.kernel.coupling``; (0, 3) without.
    """

    parent: npt.NDArray[np.int64]
    slides: npt.NDArray[np.int64]
    frames: npt.NDArray[np.float64]
    coupling: npt.NDArray[np.float64] = NOTHING_COUPLED


class Places(NamedTuple):
    """Memory of one configuration and one motion.

    Attributes:
        bodies: (1+N, 24) see the columns here and in `kernel.motion`.
        axes: (6+N, 6) see the columns here.
        joints: (4, 6+N) x, x', x_r' and x_r'' of all joints; only used where some follow others.
        rows: (6+N, 10 (1+N)) regressor of all joints; (0, 0) where none follows another.
    """

    bodies: npt.NDArray[np.float64]
    axes: npt.NDArray[np.float64]
    joints: npt.NDArray[np.float64]
    rows: npt.NDArray[np.float64]


def tree_of(model: Any) -> Tree:
    """The arrays of a Pinocchio model.

    Args:
        model: free-flyer root, then joints with one degree of freedom each or JointModelMimic, no gravity, no armature.

    Raises:
        SpecError: the model is not such a robot.
    """
    along, sliding = joint_axes(model)
    bodies = model.njoints - 1
    frames = np.zeros((bodies, 15))
    for body in range(1, bodies):
        placement = model.jointPlacements[body + 1]
        frames[body] = [*placement.rotation.ravel(), *placement.translation, *along[body - 1]]
    parent = np.array([max(0, model.parents[body + 1] - 1) for body in range(bodies)], dtype=np.int64)
    slides = np.array([1, 1, 1, 0, 0, 0, *sliding], dtype=np.int64)
    return Tree(parent, slides, frames, coupling_of(model))


def places(joints: int, followers: int = 0) -> Places:
    """Memory for a robot with that many joints, and others that follow them."""
    size = BASE + joints + followers
    rows = np.zeros((size, 10 * (size - 5)) if followers else (0, 0))
    return Places(np.zeros((size - 5, 24)), np.zeros((size, 6)), np.zeros((4, size)), rows)


@inner
def place(tree: Tree, x: Vector, at: Places) -> None:
    """Turn and place bodies and axes in the configuration x (6+n,)."""
    if tree.coupling.shape[0]:
        to_joints(tree.coupling, x, POSITION, at.joints[0])
        _place(tree, at.joints[0], at)
    else:
        _place(tree, x, at)


@inner
def _place(tree: Tree, x: Vector, at: Places) -> None:
    """The same of all joints (6+N,)."""
    bodies, axes = at.bodies, at.axes
    _place_base(x, at)
    for body in range(1, tree.parent.shape[0]):
        above, dof = tree.parent[body], BASE + body - 1
        turn = get9(bodies, above, TURN)
        origin = add(get3(bodies, above, PLACE), mul(turn, get3(tree.frames, body, ORIGIN)))
        turn = product(turn, get9(tree.frames, body, ROTATION))
        along = mul(turn, get3(tree.frames, body, AXIS))
        if tree.slides[dof]:
            origin = add(origin, scaled(x[dof], along))
        else:
            turn = product(turn, _about(get3(tree.frames, body, AXIS), x[dof]))
        put9(bodies, body, TURN, turn)
        put3(bodies, body, PLACE, origin)
        put3(axes, dof, ALONG, along)
        put3(axes, dof, THROUGH, origin)


@inner
def _place_base(x: Vector, at: Places) -> None:
    """R = Rz(yaw) Ry(pitch) Rx(roll), and the axes that x moves the base along and about."""
    (sy, cy), (sp, cp), (sr, cr) = sincos(x[3]), sincos(x[4]), sincos(x[5])
    put9(
        at.bodies,
        ROOT,
        TURN,
        (
            cy * cp,
            cy * sp * sr - sy * cr,
            cy * sp * cr + sy * sr,
            sy * cp,
            sy * sp * sr + cy * cr,
            sy * sp * cr - cy * sr,
            -sp,
            cp * sr,
            cp * cr,
        ),
    )
    put3(at.bodies, ROOT, PLACE, (0.0, 0.0, 0.0))
    put3(at.axes, 0, ALONG, (1.0, 0.0, 0.0))
    put3(at.axes, 1, ALONG, (0.0, 1.0, 0.0))
    put3(at.axes, 2, ALONG, (0.0, 0.0, 1.0))
    put3(at.axes, 3, ALONG, (0.0, 0.0, 1.0))
    put3(at.axes, 4, ALONG, (-sy, cy, 0.0))
    put3(at.axes, 5, ALONG, (cy * cp, sy * cp, -sp))
    for dof in range(BASE):
        put3(at.axes, dof, THROUGH, (0.0, 0.0, 0.0))


@inner
def _about(axis: Vec, angle: float) -> Mat:
    """The rotation about a unit axis (Rodrigues)."""
    x, y, z = axis
    s, c = sincos(angle)
    t = 1.0 - c
    return (
        c + t * x * x,
        t * x * y - s * z,
        t * x * z + s * y,
        t * x * y + s * z,
        c + t * y * y,
        t * y * z - s * x,
        t * x * z - s * y,
        t * y * z + s * x,
        c + t * z * z,
    )
