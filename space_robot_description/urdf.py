"""URDF text to a checked tree of links and joints in one spelling, every complaint with the link's or joint's name."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from xml.etree import ElementTree as ET

from space_robot_description.branch_order import masters_first
from space_robot_description.urdf_plain import plain_robot
from space_robot_msgs_py.bounded_xml import parse_xml
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.limits import JOINTS, NAME_LENGTH

MOVING = ("revolute", "continuous", "prismatic")


@dataclass(frozen=True, slots=True)
class Tree:
    """A checked URDF.

    Attributes:
        root: the ``<robot>`` element.
        links: link name -> element, document order.
        joints: joint name -> element, document order.
        root_link: the one link that is no link's child.
        children: link name -> its joints, sorted by joint name as Pinocchio visits them; a joint that mimics another
            one stands behind it.
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
        SpecError: not XML, not a URDF, xacro, a name twice or unknown, several roots, a loop, or an element or
            attribute that would have a meaning and is spelt in no way of URDF.
    """
    root = parse_xml(text, where)
    plain_robot(root, where)
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
    if not links:
        raise SpecError("a URDF has one root link", key=where, value="no link", accepted="<link name=...>")
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
    masters = {
        name: mimic.get("joint", "") for name, joint in joints.items() if (mimic := joint.find("mimic")) is not None
    }
    if masters:
        children.update(masters_first(children, {name: child_of(joint) for name, joint in joints.items()}, masters))
    return tree
