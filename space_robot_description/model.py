"""A checked URDF tree to a Pinocchio model: free-flyer root, one coordinate per joint, no gravity.

The model is made of the numbers that were checked, joint by joint and body by body; no other parser reads the text.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pinocchio as pin

from space_robot_description.inertia import check_body
from space_robot_description.joint_row import JointRow, read_joint
from space_robot_description.link_body import LinkBody, can_exist, read_body
from space_robot_description.mimic import couple, read_mimics
from space_robot_description.sums import check_sums
from space_robot_description.urdf import MOVING, Tree, child_of, kind_of, parent_of
from space_robot_description.urdf_values import placement_of
from space_robot_msgs_py.errors import InertiaError, SpecError
from space_robot_msgs_py.interfaces import Vector

ROOT_JOINT = "root_joint"
_ALIGNED = {
    (1.0, 0.0, 0.0): (pin.JointModelRX, pin.JointModelPX),
    (0.0, 1.0, 0.0): (pin.JointModelRY, pin.JointModelPY),
    (0.0, 0.0, 1.0): (pin.JointModelRZ, pin.JointModelPZ),
}


def build_model(tree: Tree) -> tuple[Any, dict[str, JointRow]]:
    """Check every joint and body and build the model.

    Args:
        tree: of the composed URDF.

    Returns:
        ``pin.Model`` with gravity zero, and the joints that have a coordinate in its order: all that move, but for
        those that mimic another one, which are ``JointModelMimic`` in the model.

    Raises:
        SpecError: a joint that cannot be a single coordinate, or bad limits.
        InertiaError: a body that cannot exist, or a moving link without mass.
    """
    bodies = {name: read_body(name, link) for name, link in tree.links.items()}
    rows = {name: row for name, joint in tree.joints.items() if (row := read_joint(name, joint)) is not None}
    if not rows:
        raise SpecError("no moving joint is left", key="urdf", accepted="a robot with at least one")
    rows = {name: rows[name] for name in tree.walk() if name in rows}
    mimics = read_mimics(tree)
    model = couple(_assembled(tree, bodies, rows), mimics)
    model.gravity.setZero()
    _check_bodies(tree, bodies, model, moving_links(tree, model))
    check_sums(tree, bodies, model)
    return model, {name: row for name, row in rows.items() if name not in mimics}


def moving_links(tree: Tree, model: Any) -> tuple[str, ...]:
    """The links whose bodies move, in the order of the model, base first."""
    return (tree.root_link, *(child_of(tree.joints[name]) for name in list(model.names)[2:]))


def end_of_arm(tree: Tree) -> str:
    """The link ``tool`` if there is one, else the leaf behind the most moving joints, the first in model order."""
    if "tool" in tree.links:
        return "tool"
    depth = {tree.root_link: 0}
    for name in tree.walk():
        joint = tree.joints[name]
        depth[child_of(joint)] = depth[parent_of(joint)] + (kind_of(joint) in MOVING)
    leaves = [link for link in depth if not tree.children[link]]
    return max(leaves, key=depth.__getitem__)


def _assembled(tree: Tree, bodies: Mapping[str, LinkBody], rows: Mapping[str, JointRow]) -> Any:
    model = pin.Model()
    model.name = "robot"
    root = ROOT_JOINT
    while root in tree.joints:
        root += "_"
    index = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), root)
    frame = model.addJointFrame(index, 0)
    model.appendBodyToJoint(index, bodies[tree.root_link].spatial(), pin.SE3.Identity())
    frames = {tree.root_link: _add_body_frame(model, tree.root_link, frame)}
    for name in tree.walk():
        joint = tree.joints[name]
        parent, placement = frames[parent_of(joint)], placement_of(joint, f"joint {name}")
        body = bodies[child_of(joint)].spatial()
        if name in rows:
            frame = _add_joint(model, name, rows[name], body, placement, parent)
        else:
            frame = _add_fixed(model, name, body, placement, parent)
        frames[child_of(joint)] = _add_body_frame(model, child_of(joint), frame)
    return model


def _add_body_frame(model: Any, link: str, frame: int) -> int:
    """Add the frame of a link where the frame of its joint stands."""
    at = model.frames[frame]
    return int(model.addBodyFrame(link, at.parentJoint, at.placement, frame))


def _add_fixed(model: Any, name: str, body: Any, placement: Any, parent: int) -> int:
    """Add the frame of a fixed joint, and the body behind it to the joint that moves it."""
    at = model.frames[parent]
    place = at.placement * placement
    return int(model.addFrame(pin.Frame(name, at.parentJoint, parent, place, pin.FrameType.FIXED_JOINT, body), True))


def _add_joint(model: Any, name: str, row: JointRow, body: Any, placement: Any, parent: int) -> int:
    at = model.frames[parent]
    none = np.zeros(1)
    limits = (none, none, np.array([row.lower]), np.array([row.upper]))
    index = model.addJoint(at.parentJoint, _joint_model(row), at.placement * placement, name, *limits)
    # Frames first: each adds an inertia of zero, which is no more than round-off, and the order of sums is the bits.
    frame = int(model.addJointFrame(index, parent))
    model.appendBodyToJoint(index, body, pin.SE3.Identity())
    return frame


def _check_bodies(tree: Tree, bodies: Mapping[str, LinkBody], model: Any, moving: Sequence[str]) -> None:
    ends = set(range(1, model.njoints)) - set(model.parents[1:])
    for index, link in enumerate(moving, start=1):
        inertia = model.inertias[index]
        if inertia.mass == 0.0 and not np.any(inertia.inertia) and index in ends:
            accepted = "an <inertial> with mass and inertia, on it or on what is fixed to it"
            raise InertiaError("a moving link has no mass", key=f"link {link}", value=inertia.mass, accepted=accepted)
        try:
            check_body(link, inertia.mass, inertia.lever, inertia.inertia)
        except InertiaError as error:
            wrong = [n for n in _parts(tree, link) if bodies[n].mass > 0.0 and not can_exist(n, bodies[n])]
            advice = f"; or inertia: {{project: [{', '.join(wrong)}]}} in the robot file" if wrong else ""
            accepted = f"{error.accepted}{advice}"
            raise InertiaError(error.message, key=error.key, value=error.value, accepted=accepted) from None


def _parts(tree: Tree, link: str) -> list[str]:
    """The link and all that is fixed to it."""
    parts = [link]
    for part in parts:
        fixed = [joint for name in tree.children[part] if kind_of(joint := tree.joints[name]) not in MOVING]
        parts += [child_of(joint) for joint in fixed]
    return parts


def _joint_model(row: JointRow) -> Any:
    axis: Vector = row.axis
    aligned = _ALIGNED.get(tuple(axis.tolist()))
    if aligned is not None:
        return aligned[row.prismatic]()
    return (pin.JointModelPrismaticUnaligned if row.prismatic else pin.JointModelRevoluteUnaligned)(axis)
