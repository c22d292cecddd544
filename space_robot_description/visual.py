"""What a robot looks like: the visuals of its URDF as Pinocchio geometry, with every mesh that can be found."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any
from xml.etree import ElementTree as ET

import pinocchio as pin

from space_robot_description.model import build_model, end_of_arm
from space_robot_description.share import mesh_file
from space_robot_description.urdf import Tree, parse_urdf


@dataclass(frozen=True, eq=False, slots=True)
class Look:
    """A robot to be drawn.

    Attributes:
        model: ``pin.Model`` as controllers have it.
        visuals: ``pin.GeometryModel`` of its visuals; mesh paths are those of this machine.
        tool: the link at the end of the arm.
        missing: meshes that are not on this machine or cannot be read; their links are drawn without them.
    """

    model: Any
    visuals: Any
    tool: str
    missing: tuple[str, ...]


def look_of(urdf: str) -> Look:
    """The looks of a robot.

    Args:
        urdf: composed, as in a log.

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
            mesh = visual.find("geometry/mesh")
            uri = "" if mesh is None else mesh.get("filename", "")
            path = mesh_file(uri) if uri else None
            if mesh is not None and path is not None:
                mesh.set("filename", str(path))
            if (uri and path is None) or not _add(model, visuals, _alone(tree, name, visual)):
                missing.append(uri or f"visual of {name}")
    return Look(model, visuals, end_of_arm(tree), tuple(missing))


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
    robot.extend(tree.root.findall("material"))
    ET.SubElement(robot, "link", name=name).append(visual)
    return ET.tostring(robot, encoding="unicode")
