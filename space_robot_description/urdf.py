"""URDF text to a checked tree: names, axes, limits and inertias, every complaint with the link's or joint's name."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from xml.etree import ElementTree as ET

import numpy as np

from space_robot_description.inertia import check_inertia
from space_robot_description.spec import MAX_MAGNITUDE
from space_robot_msgs_py.bounded_xml import parse_xml
from space_robot_msgs_py.errors import InertiaError, SpecError
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.limits import JOINTS, NAME_LENGTH

MOVING = ("revolute", "continuous", "prismatic")
# Simulator and driver extensions say nothing about the body; they also quote joint names that may be changed here.
IGNORED = ("gazebo", "transmission", "ros2_control")


@dataclass(frozen=True, slots=True)
class Tree:
    """A checked URDF.

    Attributes:
        root: the ``<robot>`` element.
        links: link name -> element, document order.
        joints: joint name -> element, document order.
        root_link: the one link that is no link's child.
        children: link name -> its joints, sorted by joint name as Pinocchio visits them.
    """

    root: ET.Element
    links: dict[str, ET.Element]
    joints: dict[str, ET.Element]
    root_link: str
    children: dict[str, list[str]]

    def walk(self) -> Iterator[str]:
        """Joint names, depth first from the root: Pinocchio's order."""
        stack = list(reversed(self.children[self.root_link]))
        while stack:
            name = stack.pop()
            yield name
            stack.extend(reversed(self.children[child_of(self.joints[name])]))


def parse_urdf(text: str, where: str) -> Tree:
    """Parse URDF text and check that it is one tree of links and joints.

    Raises:
        SpecError: not XML, not a URDF, xacro, a name twice or unknown, several roots, or a loop.
    """
    root = parse_xml(text, where)
    if root.tag != "robot":
        raise SpecError("not a URDF", key=where, value=f"<{root.tag}>", accepted="<robot> at the top")
    if any(str(element.tag).startswith("{") for element in root.iter()) or "${" in text:
        raise SpecError(
            "xacro or foreign elements in the URDF", key=where, accepted="plain URDF: run xacro on it first"
        )
    for element in [child for child in root if child.tag in IGNORED]:
        root.remove(element)
    links, joints = _named(root, "link", where), _named(root, "joint", where)
    return _tree(root, links, joints, where)


def kind_of(joint: ET.Element) -> str:
    """The joint's type."""
    return joint.get("type", "")


def parent_of(joint: ET.Element) -> str:
    """Name of the link the joint stands on."""
    return _link_attribute(joint, "parent")


def child_of(joint: ET.Element) -> str:
    """Name of the link the joint moves."""
    return _link_attribute(joint, "child")


def axis_of(joint: ET.Element, key: str) -> Vector:
    """The joint's unit axis (3,) in the joint frame.

    Raises:
        SpecError: not three finite numbers, or no direction.
    """
    axis = numbers(joint.find("axis"), "xyz", "1 0 0", key)
    length = float(np.linalg.norm(axis))
    if length < 1e-6:
        raise SpecError("axis has no direction", key=key, value=axis.tolist(), accepted="a vector of length 1")
    # An axis of length 1 is left alone: dividing by 1 + 1e-16 would make x, y, z axes into general ones.
    return axis if abs(length - 1.0) < 1e-15 else axis / length


def numbers(element: ET.Element | None, attribute: str, default: str, key: str) -> Vector:
    """Three finite numbers of an attribute such as ``xyz``.

    Raises:
        SpecError: not three finite numbers, or one beyond ``MAX_MAGNITUDE``.
    """
    text = default if element is None else element.get(attribute, default)
    values = [_to_float(part) for part in text.split()]
    if len(values) != 3 or not all(abs(value) <= MAX_MAGNITUDE for value in values):
        accepted = f"three finite numbers, none beyond {MAX_MAGNITUDE:g}"
        raise SpecError(f"{attribute} is not a vector", key=key, value=text, accepted=accepted)
    return np.array(values)


def number(element: ET.Element, attribute: str, key: str) -> float | None:
    """One number of an attribute, None if it is absent.

    Raises:
        SpecError: not a finite number.
    """
    text = element.get(attribute)
    if text is None:
        return None
    value = _to_float(text)
    if not math.isfinite(value):
        raise SpecError(f"{attribute} is not a number", key=key, value=text, accepted="a finite number")
    return value


def check_link_inertia(name: str, link: ET.Element) -> float:
    """Check the ``<inertial>`` of a link and return its mass [kg]; 0 for a massless frame.

    Raises:
        InertiaError: mass without inertia, or a body that cannot exist.
    """
    inertial = link.find("inertial")
    if inertial is None:
        return 0.0
    key = f"link {name}"
    mass_element, inertia_element = inertial.find("mass"), inertial.find("inertia")
    mass = 0.0 if mass_element is None else _physical(mass_element, "value", key)
    entries = {entry: 0.0 for entry in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")}
    if inertia_element is not None:
        entries = {entry: _physical(inertia_element, entry, key) for entry in entries}
    if mass == 0.0 and not any(entries.values()):
        return 0.0
    if mass > 0.0 and not any(entries.values()):
        raise InertiaError(
            "the link has mass but no inertia", key=key, value=mass, accepted="<inertia ixx=... > of the link"
        )
    ixx, iyy, izz, ixy, ixz, iyz = entries.values()
    try:
        com, _ = (numbers(inertial.find("origin"), attribute, "0 0 0", key) for attribute in ("xyz", "rpy"))
    except SpecError as error:
        raise InertiaError(error.message, key=key, value=error.value, accepted=error.accepted) from None
    check_inertia(name, mass, com, np.array([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]]))
    return mass


def _to_float(text: str) -> float:
    """The number in a text, NaN if there is none; Python alone would read 1_0 as ten."""
    try:
        return math.nan if "_" in text else float(text)
    except ValueError:
        return math.nan


def _physical(element: ET.Element, attribute: str, key: str) -> float:
    text = element.get(attribute, "0")
    value = _to_float(text)
    if not math.isfinite(value):
        name = "mass" if element.tag == "mass" else attribute
        raise InertiaError(f"{name} is not a finite number", key=key, value=text, accepted="a finite number")
    return value


def _named(root: ET.Element, tag: str, where: str) -> dict[str, ET.Element]:
    found: dict[str, ET.Element] = {}
    for element in root.findall(tag):
        name = element.get("name", "")
        if not name:
            raise SpecError(f"a <{tag}> has no name", key=where)
        NAME_LENGTH.check(len(name.encode()), f"{where} {tag} {name[:40]}")
        if name in found:
            raise SpecError(f"the {tag} name appears twice", key=where, value=name)
        found[name] = element
    JOINTS.check(len(found), f"{where} {tag}s")
    return found


def _link_attribute(joint: ET.Element, tag: str) -> str:
    element = joint.find(tag)
    return "" if element is None else element.get("link", "")


def _tree(root: ET.Element, links: dict[str, ET.Element], joints: dict[str, ET.Element], where: str) -> Tree:
    children: dict[str, list[str]] = {name: [] for name in links}
    parents: dict[str, str] = {}
    for name in sorted(joints):
        parent, child = parent_of(joints[name]), child_of(joints[name])
        for link in (parent, child):
            if link not in links:
                raise SpecError(
                    f"joint {name} names an unknown link", key=where, value=link, accepted="a <link> of the URDF"
                )
        if child in parents:
            raise SpecError(f"link {child} is the child of two joints", key=where, value=f"{parents[child]}, {name}")
        parents[child] = name
        children[parent].append(name)
    roots = [name for name in links if name not in parents]
    if len(roots) != 1:
        raise SpecError("a URDF has one root link", key=where, value=roots or "none (a loop)", accepted="a single tree")
    tree = Tree(root, links, joints, roots[0], children)
    if lost := sorted(set(joints) - set(tree.walk())):
        raise SpecError("joints form a loop", key=where, value=", ".join(lost), accepted="a single tree")
    return tree
