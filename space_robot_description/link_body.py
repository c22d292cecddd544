"""The rigid body of one link: mass, centre and inertia of its ``<inertial>``, in the axes of the link."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
import pinocchio as pin

from space_robot_description.inertia import MAX_MAGNITUDE, check_body
from space_robot_description.urdf_values import placement_of, to_float
from space_robot_msgs_py.errors import InertiaError, SpecError
from space_robot_msgs_py.interfaces import Vector

INERTIA_ENTRIES = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")


@dataclass(frozen=True, eq=False, slots=True)
class LinkBody:
    """What a link weighs; whether it can exist is asked of the moving body that it is a part of.

    Attributes:
        mass: [kg], not negative; 0 for a frame.
        com: (3,) centre of mass in the link [m].
        inertia: (3, 3) about the centre of mass, axes of the link [kg m2]; zero for a point mass.
    """

    mass: float
    com: Vector
    inertia: Vector

    def spatial(self) -> Any:
        """``pin.Inertia`` in the link; set field by field, as its constructor refuses what may be part of a body."""
        inertia = pin.Inertia.Zero()
        inertia.mass, inertia.lever, inertia.inertia = self.mass, self.com, self.inertia
        return inertia


NO_BODY = LinkBody(0.0, np.zeros(3), np.zeros((3, 3)))


def read_body(name: str, link: ET.Element) -> LinkBody:
    """The body of a link in the one spelling of ``plain_robot``.

    Without ``<inertial>`` it is a frame; mass without ``<inertia>``, or with zeros, is a point mass.

    Raises:
        InertiaError: a value that is no finite number, is missing or is beyond any spacecraft, or a negative mass.
    """
    inertial = link.find("inertial")
    if inertial is None:
        return NO_BODY
    key = f"link {name}"
    tensor = _tensor(inertial.find("inertia"), key)
    mass = _mass(inertial.find("mass"), key, needed=bool(np.any(tensor)))
    if mass == 0.0 and not np.any(tensor):
        return NO_BODY
    try:
        placement = placement_of(inertial, key)
    except SpecError as error:
        raise InertiaError(error.message, key=key, value=error.value, accepted=error.accepted) from None
    return LinkBody(mass, placement.translation, turned(tensor, placement.rotation))


def can_exist(name: str, body: LinkBody) -> bool:
    """Whether a link could be a body by itself, points, rods and plates included."""
    try:
        check_body(name, body.mass, body.com, body.inertia)
    except InertiaError:
        return False
    return True


def turned(inertia: Vector, rotation: Vector) -> Vector:
    """R I R^T of (3, 3) arrays in scalars, exactly symmetric: the bits depend on no linear algebra library."""
    first = _product(rotation.tolist(), inertia.tolist())
    second = np.array(_product(first, rotation.T.tolist()))
    lower = np.tril(second)
    whole: Vector = lower + np.tril(lower, -1).T
    return whole


def _product(a: list[list[float]], b: list[list[float]]) -> list[list[float]]:
    return [[row[0] * b[0][j] + row[1] * b[1][j] + row[2] * b[2][j] for j in range(3)] for row in a]


def _mass(element: ET.Element | None, key: str, *, needed: bool) -> float:
    if element is None:
        if needed:
            raise InertiaError("<inertial> has no <mass>", key=key, accepted='<mass value="..."/>')
        return 0.0
    mass = _number(element, "value", "mass", key)
    if mass < 0.0:
        raise InertiaError("mass is negative", key=key, value=mass, accepted=">= 0 kg")
    return mass


def _tensor(element: ET.Element | None, key: str) -> Vector:
    if element is None or not element.attrib:
        return np.zeros((3, 3))
    ixx, iyy, izz, ixy, ixz, iyz = (_number(element, entry, entry, key) for entry in INERTIA_ENTRIES)
    return np.array([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]])


def _number(element: ET.Element, attribute: str, name: str, key: str) -> float:
    text = element.get(attribute)
    if text is None:
        accepted = f'<{element.tag} {attribute}="..."/>'
        raise InertiaError(f"<{element.tag}> has no {attribute}", key=key, accepted=accepted)
    value = to_float(text)
    if not math.isfinite(value):
        raise InertiaError(f"{name} is not a finite number", key=key, value=text, accepted="a finite number")
    if abs(value) > MAX_MAGNITUDE:
        what = "mass" if name == "mass" else "inertia"
        accepted = f"below {MAX_MAGNITUDE:g}"
        raise InertiaError(f"{what} is beyond any spacecraft", key=key, value=text, accepted=accepted)
    return value
