"""Values in a URDF: strict in what a number is, lenient in how it is spelt; nothing that means something is skipped."""

from __future__ import annotations

import difflib
import math
import re
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
import pinocchio as pin

from space_robot_description.spec import MAX_MAGNITUDE
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.elementary import sincos
from space_robot_msgs_py.kernel.products import norm

# What may stand in the elements of which every attribute is used, or refused by name.
ATTRIBUTES: dict[str, tuple[str, ...]] = {
    "inertial": (),
    "origin": ("xyz", "rpy", "quat_xyzw"),
    "mass": ("value",),
    "inertia": ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"),
    "parent": ("link",),
    "child": ("link",),
    "axis": ("xyz",),
    "limit": ("lower", "upper", "effort", "velocity", "acceleration", "deceleration", "jerk"),
    "mimic": ("joint", "multiplier", "offset"),
}
# Drivers and simulators have limits of their own there; only what looks like a misspelt one of URDF's is refused.
EXTENDED = ("limit",)
# Python's own float would also read 1_0, the digits of other scripts, and infinities.
_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
_COUNTS = {3: "three", 4: "four"}


def to_float(text: str) -> float:
    """The decimal number in a text, whatever blanks stand around it; NaN if there is none."""
    stripped = text.strip()
    return float(stripped) if _NUMBER.fullmatch(stripped) else math.nan


def number(element: ET.Element, attribute: str, key: str) -> float | None:
    """One number of an attribute, None if it is absent.

    Raises:
        SpecError: not a finite number.
    """
    text = element.get(attribute)
    if text is None:
        return None
    value = to_float(text)
    if not math.isfinite(value):
        raise SpecError(f"{attribute} is not a number", key=key, value=text, accepted="a finite number")
    return value


def numbers(element: ET.Element | None, attribute: str, default: str, key: str) -> Vector:
    """As many finite numbers of an attribute such as ``xyz`` as its default has.

    Raises:
        SpecError: not so many finite numbers, or one beyond ``MAX_MAGNITUDE``.
    """
    text = default if element is None else element.get(attribute, default)
    values = [to_float(part) for part in text.split()]
    count = len(default.split())
    if len(values) != count or not all(abs(value) <= MAX_MAGNITUDE for value in values):
        accepted = f"{_COUNTS[count]} finite numbers, none beyond {MAX_MAGNITUDE:g}"
        raise SpecError(f"{attribute} is not a vector", key=key, value=text, accepted=accepted)
    return np.array(values)


def single(owner: ET.Element, tag: str, key: str) -> ET.Element | None:
    """The child of that tag, None if there is none, with no attribute that has no meaning.

    Raises:
        SpecError: there are several, or an attribute is none of URDF's.
    """
    found = owner.findall(tag)
    if len(found) > 1:
        raise SpecError(f"has <{tag}> {len(found)} times", key=key, accepted="once")
    if not found:
        return None
    known = ATTRIBUTES[tag]
    unknown = [name for name in found[0].attrib if name not in known]
    if tag in EXTENDED:
        unknown = [name for name in unknown if difflib.get_close_matches(name, known, n=1, cutoff=0.8)]
    if unknown:
        accepted = ", ".join(known) or "none"
        raise SpecError(f"<{tag}> has an attribute that is none of URDF", key=key, value=unknown[0], accepted=accepted)
    return found[0]


def placement_of(owner: ET.Element, key: str) -> Any:
    """``pin.SE3`` of the ``<origin>`` in an element, the identity without one; ``rpy`` is R = Rz Ry Rx.

    The rotation goes through the quaternion, as urdfdom's does: every URDF reader on top of it has these bits.

    Raises:
        SpecError: not three finite numbers.
    """
    origin = owner.find("origin")
    rpy = numbers(origin, "rpy", "0 0 0", key)
    return pin.SE3(rotation_of_rpy(rpy), numbers(origin, "xyz", "0 0 0", key))


def rotation_of_rpy(rpy: Vector) -> Vector:
    """The (3, 3) rotation Rz(yaw) Ry(pitch) Rx(roll)."""
    (s1, c1), (s2, c2), (s3, c3) = map(sincos, (0.5 * rpy).tolist())
    x = s1 * c2 * c3 - c1 * s2 * s3
    y = c1 * s2 * c3 + s1 * c2 * s3
    z = c1 * c2 * s3 - s1 * s2 * c3
    w = c1 * c2 * c3 + s1 * s2 * s3
    length = math.sqrt(x * x + y * y + z * z + w * w)
    matrix: Vector = pin.Quaternion(w / length, x / length, y / length, z / length).toRotationMatrix()
    return matrix


def axis_of(joint: ET.Element, key: str) -> Vector:
    """The joint's unit axis (3,) in the joint frame.

    Raises:
        SpecError: not three finite numbers, or no direction.
    """
    axis = numbers(joint.find("axis"), "xyz", "1 0 0", key)
    length = norm(axis)
    if length < 1e-6:
        raise SpecError("axis has no direction", key=key, value=axis.tolist(), accepted="a vector of length 1")
    # An axis of length 1 is left alone: dividing by 1 + 1e-16 would make x, y, z axes into general ones.
    return axis if abs(length - 1.0) < 1e-15 else axis / length
