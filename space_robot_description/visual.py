"""What a robot looks like: the visuals of its URDF as Pinocchio geometry, with every mesh that can be found."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import pinocchio as pin

from space_robot_description.model import build_model, end_of_arm
from space_robot_description.share import mesh_file
from space_robot_description.urdf import Tree, parse_urdf
from space_robot_msgs_py.limits import MESH_BYTES


@dataclass(frozen=True, eq=False, slots=True)
class Look:
    """A robot to be drawn.

    Attributes:
        model: ``pin.Model`` as controllers have it.
        visuals: ``pin.GeometryModel`` of its visuals; mesh paths are those of this machine.
        tool: the link at the end of the arm.
        missing: meshes that are not on this machine, may not be read or cannot; their links are drawn without them.
    """

    model: Any
    visuals: Any
    tool: str
    missing: tuple[str, ...]


def look_of(urdf: str, folders: Sequence[Path] = ()) -> Look:
    """The looks of a robot.

    Args:
        urdf: composed, as in a log.
        folders: of meshes that may be read beside those of shipped robots, ROS packages and wheels.

    Raises:
        SpecError: the text is no robot.
        InertiaError: it is none that could exist.
    """
    tree = parse_urdf(urdf, "urdf")
    model, _ = build_model(tree)
    visuals = pin.GeometryModel()
    missing: list[str] = []
    # Visual by visual: a mesh that is not there costs one link its looks, not the robot.
    for name, link in tree.links.items():
        for visual in link.findall("visual"):
            lost = _unfound(visual, folders)
            if lost or not _add(model, visuals, _alone(tree, name, visual)):
                missing.append(lost or _named(visual) or f"visual of {name}")
    return Look(model, visuals, end_of_arm(tree), tuple(missing))


def _unfound(visual: ET.Element, folders: Sequence[Path]) -> str:
    """Put the files of this machine into a visual; returns the first that is not there or may not be read."""
    for mesh in visual.iter("mesh"):
        uri = mesh.get("filename", "")
        path = mesh_file(uri, folders) if uri else None
        if path is None or path.stat().st_size > MESH_BYTES.most:
            return uri or "a mesh without a name"
        mesh.set("filename", str(path))
        mesh.set("uri", uri)
    # Pictures on surfaces are files as well, and nothing here draws them.
    for material in visual.iter("material"):
        for texture in material.findall("texture"):
            material.remove(texture)
    return ""


def _named(visual: ET.Element) -> str:
    """The mesh of a visual as the URDF called it."""
    mesh = next(visual.iter("mesh"), None)
    return "" if mesh is None else mesh.get("uri", "")


def _add(model: Any, visuals: Any, text: str) -> bool:
    """Whether Pinocchio could read the one visual in this text."""
    try:
        pin.buildGeomFromUrdfString(model, text, pin.GeometryType.VISUAL, visuals)
    except (ValueError, RuntimeError):
        return False
    # Every text has one visual, so Pinocchio gives all of a link the same name.
    for index, part in enumerate(visuals.geometryObjects):
        part.name = f"{model.frames[part.parentFrame].name}_{index}"
    return True


def _alone(tree: Tree, name: str, visual: ET.Element) -> str:
    """A URDF of one link with one visual, and with the materials it may refer to."""
    robot = ET.Element("robot", name="robot")
    # Only their colors: a texture is a file.
    for material in tree.root.findall("material"):
        bare = ET.SubElement(robot, "material", {"name": material.get("name", "")})
        bare.extend(material.findall("color"))
    ET.SubElement(robot, "link", name=name).append(visual)
    return ET.tostring(robot, encoding="unicode")
