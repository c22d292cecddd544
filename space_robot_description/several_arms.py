"""Several arms on one satellite: one URDF, every name of an arm behind the arm's own."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from xml.etree import ElementTree as ET

from space_robot_description.compose import BASE_LINK, absolute_meshes, satellite, stand_on
from space_robot_description.model import end_of_arm
from space_robot_description.robot_spec import ArmSpec, RobotSpec
from space_robot_description.urdf import Tree, parse_urdf
from space_robot_description.validation import nearest
from space_robot_msgs_py.errors import SpecError


def join_arms(spec: RobotSpec, texts: Mapping[str, tuple[str, Path | None]]) -> tuple[str, dict[str, str]]:
    """The whole robot as one URDF, and the link at the end of each arm.

    Links, joints and materials of the arm ``left`` are called ``left_`` and their name; so are the joints that its
    ``<mimic>`` elements follow. The joint on which it stands is ``left_mount``.

    Args:
        spec: the robot file, with ``base`` and ``arms``.
        texts: arm -> its URDF, and where that lies, for relative mesh paths.

    Raises:
        SpecError: a URDF cannot be used, an arm has no such tool, or two names are the same now.
    """
    assert spec.base is not None
    robot = ET.Element("robot", name=spec.name)
    robot.append(satellite(spec.base))
    tools: dict[str, str] = {}
    for name, arm in spec.arms.items():
        text, folder = texts[name]
        tree = parse_urdf(text, f"arms.{name} urdf")
        if folder is not None:
            absolute_meshes(tree.root, folder)
        tools[name] = f"{name}_{_tool(name, arm, tree)}"
        root = f"{name}_{tree.root_link}"
        parts = [part for part in tree.root if part.tag in ("link", "joint", "material")]
        _prefix(parts, f"{name}_")
        robot.append(stand_on(f"{name}_mount", arm.mount, root))
        robot.extend(parts)
    _once(robot)
    return ET.tostring(robot, encoding="unicode"), tools


def _tool(name: str, arm: ArmSpec, tree: Tree) -> str:
    if arm.tool is None:
        return end_of_arm(tree)
    if arm.tool not in tree.links:
        accepted = nearest(arm.tool, tree.links) or ", ".join(tree.links)
        raise SpecError("no such link", key=f"arms.{name}.tool", value=arm.tool, accepted=accepted)
    return arm.tool


def _prefix(parts: list[ET.Element], prefix: str) -> None:
    """Put the arm's name before every name of it."""
    for part in parts:
        part.set("name", prefix + part.get("name", ""))
        for end in (*part.findall("parent"), *part.findall("child")):
            end.set("link", prefix + end.get("link", ""))
        for mimic in part.findall("mimic"):
            if mimic.get("joint"):
                mimic.set("joint", prefix + mimic.get("joint", ""))
        for material in part.findall(".//material"):
            if material.get("name"):
                material.set("name", prefix + material.get("name", ""))


def _once(robot: ET.Element) -> None:
    seen: set[tuple[str, str]] = set()
    for part in robot:
        one = part.tag, part.get("name", "")
        if one in seen and part.tag != "material":
            accepted = f"other names of the arms; {BASE_LINK} is the satellite"
            raise SpecError(f"two arms have a {one[0]} of this name", key="arms", value=one[1], accepted=accepted)
        seen.add(one)
