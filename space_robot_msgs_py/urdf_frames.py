"""Where the links of a URDF stand in each other: as much of the robot as its transforms need."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from xml.etree import ElementTree as ET

import numpy as np

from space_robot_msgs_py.bounded_xml import parse_xml
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.elementary import sincos
from space_robot_msgs_py.mimic import Mimic


@dataclass(frozen=True, eq=False, slots=True)
class FrameJoint:
    """One joint: where its child stands in its parent, and how it moves.

    Attributes:
        name: of the joint.
        parent: link.
        child: link.
        translation: (3,) of the child in the parent at position 0 [m].
        rotation: (4,) quaternion x, y, z, w of the child in the parent at position 0.
        axis: (3,) unit axis in the child's frame.
        prismatic: it slides along the axis; all others turn about it.
        mimic: what it follows; None: nothing.
    """

    name: str
    parent: str
    child: str
    translation: Vector
    rotation: Vector
    axis: Vector
    prismatic: bool
    mimic: Mimic | None = None


def read_frames(urdf: str) -> tuple[str | None, dict[str, FrameJoint]]:
    """The root link and the joints by name; nothing where the text is no URDF."""
    try:
        robot = parse_xml(urdf, "urdf")
        joints = {joint.get("name", ""): _joint(joint) for joint in robot.findall("joint")}
    except ValueError:
        return None, {}
    children = {joint.child for joint in joints.values()}
    roots = [name for link in robot.findall("link") if (name := link.get("name", "")) not in children]
    return (roots[0], joints) if len(roots) == 1 else (None, {})


def _joint(element: ET.Element) -> FrameJoint:
    parent, child = (_attribute(element, tag, "link", "") for tag in ("parent", "child"))
    axis = _numbers(_attribute(element, "axis", "xyz", "1 0 0"))
    return FrameJoint(
        name=element.get("name", ""),
        parent=parent,
        child=child,
        translation=_numbers(_attribute(element, "origin", "xyz", "0 0 0")),
        rotation=_rotation(element),
        axis=axis / (float(np.linalg.norm(axis)) or 1.0),
        prismatic=element.get("type") == "prismatic",
        mimic=_mimic(element),
    )


def _mimic(element: ET.Element) -> Mimic | None:
    leader = _attribute(element, "mimic", "joint", "")
    multiplier, offset = (_attribute(element, "mimic", *one) for one in (("multiplier", "1"), ("offset", "0")))
    return Mimic(leader, float(_numbers(multiplier, 1)[0]), float(_numbers(offset, 1)[0])) if leader else None


def _attribute(element: ET.Element, tag: str, attribute: str, default: str) -> str:
    found = element.find(tag)
    return default if found is None else found.get(attribute, default)


def _numbers(text: str, count: int = 3) -> Vector:
    values = np.array([float(part) for part in text.split()])
    if values.shape != (count,) or not np.isfinite(values).all():
        raise ValueError(text)
    return values


def _rotation(element: ET.Element) -> Vector:
    """The quaternion (x, y, z, w) of an origin: as it is in URDF 1.1, or of its angles."""
    text = _attribute(element, "origin", "quat_xyzw", "")
    if not text:
        return _from_rpy(_numbers(_attribute(element, "origin", "rpy", "0 0 0")))
    quaternion = _numbers(text, 4)
    length = float(np.linalg.norm(quaternion))
    if not 0.0 < length < inf:
        raise ValueError(text)
    return quaternion / length


def _from_rpy(rpy: Vector) -> Vector:
    """The quaternion (x, y, z, w) of Rz(yaw) Ry(pitch) Rx(roll)."""
    x, y, z = (np.zeros(4) for _ in range(3))
    for axis, (quaternion, angle) in enumerate(zip((x, y, z), rpy, strict=True)):
        quaternion[axis], quaternion[3] = sincos(0.5 * float(angle))
    return product(z, product(y, x))


def product(a: Vector, b: Vector) -> Vector:
    """The Hamilton product of quaternions (x, y, z, w)."""
    vector = a[3] * b[:3] + b[3] * a[:3] + np.cross(a[:3], b[:3])
    return np.append(vector, a[3] * b[3] - a[:3] @ b[:3])


def rotated(rotation: Vector, axis: Vector) -> Vector:
    """The axis (3,) turned by a unit quaternion."""
    inverse = rotation * [-1.0, -1.0, -1.0, 1.0]
    return product(product(rotation, np.append(axis, 0.0)), inverse)[:3]
