"""A URDF reader of the tests' own: another parser, link by link, Newton and Euler in the inertial frame.

Nothing of the product is in it: what two readers agree on that share no line is what the file says.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any
from xml.dom import minidom

import numpy as np
from scipy.spatial.transform import Rotation


@dataclass
class Link:
    """Mass [kg], com [m] and inertia about it [kg m2] in link axes, and the joints that stand on it."""

    mass: float = 0.0
    com: Any = field(default_factory=lambda: np.zeros(3))
    inertia: Any = field(default_factory=lambda: np.zeros((3, 3)))
    joints: list[tuple[str, str, str, Any, Any, Any]] = field(default_factory=list)


def read_links(text: str) -> dict[str, Link]:
    """Every link of a URDF; a joint is (name, kind, child, rotation, translation, axis)."""
    robot = minidom.parseString(text).documentElement
    links = {node.getAttribute("name"): _link(node) for node in _children(robot, "link")}
    for node in _children(robot, "joint"):
        ends = [_children(node, tag)[0].getAttribute("link") for tag in ("parent", "child")]
        axis = np.array(_floats(node, "axis", "xyz", "1 0 0"))
        rotation, translation = _origin(node)
        row = (node.getAttribute("name"), node.getAttribute("type"), ends[1], rotation, translation)
        links[ends[0]].joints.append((*row, axis / np.linalg.norm(axis)))
    return links


def inverse_dynamics(links: dict[str, Link], root: str, q: dict[str, Any], v: dict[str, Any], a: dict[str, Any]) -> Any:
    """Wrench on the base (force, torque in its axes) and effort of each joint, by name.

    Args:
        links: of `read_links`.
        root: name of the base.
        q: joint -> position; the base stands at the origin.
        v: joint -> rate; under ``""`` the (6,) twist of the base.
        a: joint -> acceleration; under ``""`` the (6,) spatial acceleration of the base.
    """
    twist, rates = v[""], a[""]
    efforts: dict[str, Any] = {}
    state = (np.eye(3), np.zeros(3), twist[:3], twist[3:], rates[:3] + np.cross(twist[3:], twist[:3]), rates[3:])
    efforts[""] = np.concatenate(_subtree(links, root, state, (q, v, a), efforts))
    return efforts


def _subtree(links: dict[str, Link], name: str, state: Any, motion: Any, efforts: dict[str, Any]) -> Any:
    """Force and torque about the link's origin that its subtree needs, in the inertial frame."""
    turn, place, speed, omega, acceleration, alpha = state
    link = links[name]
    arm, inertia = turn @ link.com, turn @ link.inertia @ turn.T
    force = link.mass * (acceleration + np.cross(alpha, arm) + np.cross(omega, np.cross(omega, arm)))
    torque = inertia @ alpha + np.cross(omega, inertia @ omega) + np.cross(arm, force)
    for joint, kind, child, rotation, translation, axis in link.joints:
        offset, inside = turn @ translation, turn @ rotation
        at = inside @ axis
        later = acceleration + np.cross(alpha, offset) + np.cross(omega, np.cross(omega, offset))
        values = [part.get(joint, 0.0) for part in motion]
        if kind == "prismatic":
            along, rate, push = (at * value for value in values)
            later = later + np.cross(alpha, along) + np.cross(omega, np.cross(omega, along))
            there = (later + 2 * np.cross(omega, rate) + push, alpha)
            pose, spin, offset = inside, omega, offset + along
        else:
            pose = inside @ Rotation.from_rotvec(axis * values[0]).as_matrix()
            spin = omega + at * values[1]
            there = (later, alpha + at * values[2] + np.cross(omega, at * values[1]))
        push, twist = _subtree(links, child, (pose, place + offset, speed, spin, *there), motion, efforts)
        if kind != "fixed":
            efforts[joint] = at @ (push if kind == "prismatic" else twist)
        force, torque = force + push, torque + twist + np.cross(offset, push)
    return force, torque


def _link(node: Any) -> Link:
    inertials = _children(node, "inertial")
    if not inertials:
        return Link()
    names = ("ixx", "ixy", "ixz", "ixy", "iyy", "iyz", "ixz", "iyz", "izz")
    tensor = np.array([_floats(inertials[0], "inertia", name, "0")[0] for name in names]).reshape(3, 3)
    rotation, com = _origin(inertials[0])
    return Link(_floats(inertials[0], "mass", "value", "0")[0], com, rotation @ tensor @ rotation.T)


def _origin(node: Any) -> Any:
    place = np.array(_floats(node, "origin", "xyz", "0 0 0"))
    quaternion = _floats(node, "origin", "quat_xyzw", "")
    if quaternion:
        return Rotation.from_quat(quaternion).as_matrix(), place
    return Rotation.from_euler("xyz", _floats(node, "origin", "rpy", "0 0 0")).as_matrix(), place


def _floats(node: Any, tag: str, attribute: str, default: str) -> list[float]:
    found = _children(node, tag)
    text = found[0].getAttribute(attribute) if found and found[0].hasAttribute(attribute) else default
    return [float(part) for part in text.split()]


def _children(node: Any, tag: str) -> list[Any]:
    return [child for child in node.childNodes if child.nodeType == child.ELEMENT_NODE and child.localName == tag]
