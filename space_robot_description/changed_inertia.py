"""Inertias that the robot file changes: another tensor for a link, or the nearest one that can exist."""

from __future__ import annotations

from collections.abc import Mapping
from xml.etree import ElementTree as ET

import numpy as np

from space_robot_description.link_body import INERTIA_ENTRIES, LinkBody, can_exist, read_body
from space_robot_description.robot_spec import InertiaChanges, tensor
from space_robot_description.validation import nearest
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Vector


def change_inertias(links: Mapping[str, ET.Element], changes: InertiaChanges) -> tuple[str, ...]:
    """Write the tensors that the robot file asks for into the links.

    Args:
        links: name -> element, changed in place.
        changes: of the robot file.

    Returns:
        A sentence for each link: what it had, and what it has now.

    Raises:
        SpecError: no such link, one without mass, or one with nothing to project.
    """
    said = []
    for name, entries in changes.replace.items():
        body = _body(links, name, f"inertia.replace.{name}")
        wanted = tensor(entries, f"inertia.replace.{name}")
        _write(links[name], wanted)
        said.append(f"link {name}: inertia replaced by the robot file, {_change(body.inertia, wanted)}")
    for name in changes.project:
        body = _body(links, name, "inertia.project")
        if can_exist(name, body):
            accepted = "links of which the inertia cannot exist"
            raise SpecError("the inertia of this link can exist", key="inertia.project", value=name, accepted=accepted)
        wanted = nearest_inertia(body.inertia)
        _write(links[name], wanted)
        said.append(f"link {name}: inertia projected to the nearest that can exist, {_change(body.inertia, wanted)}")
    return tuple(said)


def nearest_inertia(inertia: Vector) -> Vector:
    """The (3, 3) inertia of which the second moments of mass are nearest to those given, and not negative.

    With J = tr(S) E - S the body can exist exactly if S is positive semi-definite; nearest: by the Frobenius norm of S.
    """
    values, vectors = np.linalg.eigh(0.5 * np.trace(inertia) * np.eye(3) - inertia)
    kept = np.maximum(values, 0.0)
    found: Vector = (vectors * (kept.sum() - kept)) @ vectors.T
    return 0.5 * (found + found.T)


def _body(links: Mapping[str, ET.Element], name: str, key: str) -> LinkBody:
    if name not in links:
        accepted = nearest(name, links) or ", ".join(links)
        raise SpecError("no such link", key=key, value=name, accepted=accepted)
    body = read_body(name, links[name])
    if body.mass == 0.0:
        raise SpecError("the link has no mass", key=key, value=name, accepted="a link with <mass>")
    return body


def _write(link: ET.Element, inertia: Vector) -> None:
    """Put a tensor in link axes into ``<inertial>``, the orientation of which is gone then."""
    inertial = link.find("inertial")
    assert inertial is not None, "a link with mass has one"
    element, origin = inertial.find("inertia"), inertial.find("origin")
    if element is None:
        element = ET.SubElement(inertial, "inertia")
    if origin is not None:
        origin.set("rpy", "0 0 0")
    values = inertia[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]].tolist()
    for entry, value in zip(INERTIA_ENTRIES, values, strict=True):
        element.set(entry, repr(value))


def _change(before: Vector, after: Vector) -> str:
    moments = (", ".join(f"{moment:.4g}" for moment in np.linalg.eigvalsh(tensor)) for tensor in (before, after))
    return "principal moments {} -> {} kg m2".format(*moments)
