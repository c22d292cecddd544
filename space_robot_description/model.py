"""A checked URDF tree to a Pinocchio model: free-flyer root, one coordinate per joint, no gravity."""

from __future__ import annotations

import copy
import math
from dataclasses import dataclass
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
import pinocchio as pin

from space_robot_description.inertia import check_inertia
from space_robot_description.urdf import (
    MOVING,
    Tree,
    axis_of,
    check_link_inertia,
    child_of,
    kind_of,
    number,
    numbers,
    parent_of,
)
from space_robot_msgs_py.errors import InertiaError, SpecError
from space_robot_msgs_py.interfaces import Vector

# urdfdom reads no infinity; the model gets the real one afterwards.
_UNLIMITED = 1e9
_PINOCCHIO_NAMES = ("universe", "root_joint")


@dataclass(frozen=True, eq=False, slots=True)
class JointRow:
    """One moving joint of the URDF.

    Attributes:
        axis: (3,) unit axis in the joint frame.
        lower: [rad or m], -inf for continuous.
        upper: [rad or m], +inf for continuous.
        velocity: [rad/s or m/s], +inf if absent or 0.
        effort: [N m or N], 0 if absent.
    """

    axis: Vector
    lower: float
    upper: float
    velocity: float
    effort: float


def build_model(tree: Tree) -> tuple[Any, dict[str, JointRow]]:
    """Check every joint and body and build the model.

    Args:
        tree: of the composed URDF.

    Returns:
        ``pin.Model`` with gravity zero, and the moving joints in model order.

    Raises:
        SpecError: a joint that cannot be a single coordinate, or bad limits.
        InertiaError: a body that cannot exist, or a moving link without mass.
    """
    for name, link in tree.links.items():
        check_link_inertia(name, link)
    for name in (*tree.links, *tree.joints):
        if name in _PINOCCHIO_NAMES:
            raise SpecError("the model uses this name itself", key="urdf", value=name, accepted="any other name")
    rows = {name: row for name, joint in tree.joints.items() if (row := _joint_row(name, joint)) is not None}
    if not rows:
        raise SpecError("no moving joint is left", key="urdf", accepted="a robot with at least one")
    try:
        model = pin.buildModelFromXML(_bare_urdf(tree, rows), pin.JointModelFreeFlyer())
    except (ValueError, RuntimeError) as error:
        raise SpecError(f"Pinocchio cannot build the robot: {error}", key="urdf") from None
    model.gravity.setZero()
    for index, names in enumerate(
        [tree.root_link, *(child_of(tree.joints[name]) for name in model.names[2:])], start=1
    ):
        _check_body(names, model.inertias[index])
    rows = {name: rows[name] for name in model.names[2:]}
    model.lowerPositionLimit = np.concatenate([model.lowerPositionLimit[:7], [row.lower for row in rows.values()]])
    model.upperPositionLimit = np.concatenate([model.upperPositionLimit[:7], [row.upper for row in rows.values()]])
    return model, rows


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


def _joint_row(name: str, joint: ET.Element) -> JointRow | None:
    key = f"joint {name}"
    kind = kind_of(joint)
    numbers(joint.find("origin"), "xyz", "0 0 0", key)
    numbers(joint.find("origin"), "rpy", "0 0 0", key)
    if kind == "fixed":
        return None
    if kind not in MOVING:
        hint = "; the root link is free by itself, drop this joint" if kind == "floating" else ""
        raise SpecError("joint type cannot be used", key=key, value=kind, accepted=f"fixed, {', '.join(MOVING)}{hint}")
    if joint.find("mimic") is not None:
        raise SpecError(
            "mimics another joint; a coupled joint has no effort of its own",
            key=key,
            accepted="lock it, or the joint it follows, in locked_joints",
        )
    return JointRow(axis_of(joint, key), *_limits(kind, joint.find("limit"), key))


def _limits(kind: str, limit: ET.Element | None, key: str) -> tuple[float, float, float, float]:
    if limit is None:
        if kind == "continuous":
            return -math.inf, math.inf, math.inf, 0.0
        raise SpecError(f"{kind} joint without <limit>", key=key, accepted="<limit lower= upper= effort= velocity=>")
    velocity, effort = number(limit, "velocity", key) or math.inf, number(limit, "effort", key) or 0.0
    if velocity < 0.0 or effort < 0.0:
        raise SpecError("limit is negative", key=key, value=f"velocity {velocity}, effort {effort}", accepted=">= 0")
    if kind == "continuous":
        return -math.inf, math.inf, velocity, effort
    lower, upper = number(limit, "lower", key) or 0.0, number(limit, "upper", key) or 0.0
    if not lower < upper:
        raise SpecError("limits are not in order", key=key, value=[lower, upper], accepted="lower < upper")
    return lower, upper, velocity, effort


def _bare_urdf(tree: Tree, rows: dict[str, JointRow]) -> str:
    """Only what the dynamics needs: third-party friction, mimic and mesh tags must not change the model."""
    root = ET.Element("robot", name="robot")
    for name, link in tree.links.items():
        bare = ET.SubElement(root, "link", name=name)
        if check_link_inertia(name, link) > 0.0:
            bare.extend(copy.deepcopy(link.findall("inertial")))
    for name, joint in tree.joints.items():
        row = rows.get(name)
        kind = "fixed" if row is None else "prismatic" if kind_of(joint) == "prismatic" else "revolute"
        bare = ET.SubElement(root, "joint", name=name, type=kind)
        bare.extend(copy.deepcopy([element for element in joint if element.tag in ("parent", "child")]))
        origin = {name: numbers(joint.find("origin"), name, "0 0 0", name).tolist() for name in ("xyz", "rpy")}
        ET.SubElement(bare, "origin", {name: " ".join(map(repr, values)) for name, values in origin.items()})
        if row is not None:
            ET.SubElement(bare, "axis", xyz=" ".join(map(repr, row.axis.tolist())))
            lower, upper = max(row.lower, -_UNLIMITED), min(row.upper, _UNLIMITED)
            ET.SubElement(bare, "limit", lower=repr(lower), upper=repr(upper), effort="0", velocity="0")
    return ET.tostring(root, encoding="unicode")


def _check_body(link: str, inertia: Any) -> None:
    if inertia.mass <= 0.0:
        raise InertiaError(
            "a moving link has no mass",
            key=f"link {link}",
            value=float(inertia.mass),
            accepted="an <inertial> with mass and inertia, on it or on what is fixed to it",
        )
    check_inertia(link, inertia.mass, inertia.lever, inertia.inertia)
