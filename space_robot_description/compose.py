"""One URDF of the whole robot: satellite under the arm, joints locked, limits overridden, meshes still found."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import pinocchio as pin

from space_robot_description.changed_inertia import change_inertias
from space_robot_description.inertia import check_inertia
from space_robot_description.mimic import mimic_of
from space_robot_description.robot_spec import BaseSpec, JointLimits, Pose, RobotSpec, tensor
from space_robot_description.spec import check_joint_names
from space_robot_description.urdf import MOVING, Tree, kind_of, parse_urdf
from space_robot_description.urdf_values import axis_of, numbers
from space_robot_msgs_py.errors import NonFiniteError, SpecError

BASE_LINK = "base_link"
MOUNT_JOINT = "base_mount"
# Frames of the graph's own messages; an arm's link of that name would be mistaken for them.
RESERVED = (BASE_LINK, "base_link_desired", "inertial", "world")
SATELLITE_COLOUR = "0.72 0.72 0.75 1"


def compose_urdf(spec: RobotSpec, text: str, folder: Path | None) -> tuple[str, tuple[str, ...]]:
    """The URDF of the whole robot, root link ``base_link``.

    Args:
        spec: the robot file.
        text: the URDF it names.
        folder: where that URDF lies, for relative mesh paths; None if it came as text.

    Returns:
        URDF text; composing it again without base, locks, limits and inertias gives the same text. And a sentence for
        every inertia that the robot file changes.

    Raises:
        SpecError: the URDF or the file names something that is not there.
        InertiaError: the satellite cannot exist.
    """
    tree = parse_urdf(text, f"{spec.name} urdf")
    if spec.base is None:
        _rename_root(tree)
    else:
        _mount(tree, spec.base)
    if folder is not None:
        absolute_meshes(tree.root, folder)
    _lock(tree, spec.locked_joints)
    _override_limits(tree, spec.joint_limits)
    # By the names of the result; the satellite has its own numbers in the robot file.
    said = change_inertias({link.get("name", ""): link for link in tree.links.values()}, spec.inertia)
    tree.root.set("name", spec.name)
    ET.indent(tree.root)
    return ET.tostring(tree.root, encoding="unicode") + "\n", said


def _rename_root(tree: Tree) -> None:
    if tree.root_link == BASE_LINK:
        return
    if BASE_LINK in tree.links:
        _rename_link(tree, BASE_LINK, _free_name(f"robot_{BASE_LINK}", tree.links))
    _rename_link(tree, tree.root_link, BASE_LINK)


def _mount(tree: Tree, base: BaseSpec) -> None:
    arm_root = tree.root_link
    for name in [name for name in tree.links if name in RESERVED]:
        free = _free_name(f"arm_{name}", tree.links)
        _rename_link(tree, name, free)
        arm_root = free if name == arm_root else arm_root
    tree.root.insert(0, satellite(base))
    tree.root.insert(1, stand_on(_free_name(MOUNT_JOINT, tree.joints), base.mount, arm_root))


def stand_on(name: str, mount: Pose, link: str) -> ET.Element:
    """A fixed joint between the satellite and the root link of an arm."""
    joint = ET.Element("joint", name=name, type="fixed")
    ET.SubElement(joint, "origin", xyz=_text(mount.xyz), rpy=_text(mount.rpy))
    ET.SubElement(joint, "parent", link=BASE_LINK)
    ET.SubElement(joint, "child", link=link)
    return joint


def satellite(base: BaseSpec) -> ET.Element:
    """The link under the arms.

    Raises:
        InertiaError: the satellite cannot exist.
    """
    inertia, com = tensor(base.inertia, "base.inertia"), np.array(base.com)
    check_inertia(BASE_LINK, base.mass, com, inertia)
    link = ET.Element("link", name=BASE_LINK)
    inertial = ET.SubElement(link, "inertial")
    ET.SubElement(inertial, "origin", xyz=_text(base.com), rpy="0 0 0")
    ET.SubElement(inertial, "mass", value=repr(base.mass))
    (ixx, ixy, ixz), (_, iyy, iyz), (_, _, izz) = inertia.tolist()
    entries = {"ixx": ixx, "ixy": ixy, "ixz": ixz, "iyy": iyy, "iyz": iyz, "izz": izz}
    ET.SubElement(inertial, "inertia", {name: repr(value) for name, value in entries.items()})
    visual = ET.SubElement(link, "visual")
    if base.size is None:
        # A homogeneous box has Ixx = m (b^2 + c^2) / 12 and so on; the triangle inequality makes its squares positive.
        squares = 6.0 * (np.trace(inertia) - 2.0 * np.diag(inertia)) / base.mass
        size, centre = tuple(np.round(np.sqrt(np.maximum(squares, 0.0)), 6).tolist()), base.com
    else:
        size, centre = base.size, (0.0, 0.0, 0.0)
    ET.SubElement(visual, "origin", xyz=_text(centre), rpy="0 0 0")
    ET.SubElement(ET.SubElement(visual, "geometry"), "box", size=_text(size))
    ET.SubElement(ET.SubElement(visual, "material", name="satellite"), "color", rgba=SATELLITE_COLOUR)
    return link


def _rename_link(tree: Tree, old: str, new: str) -> None:
    tree.links[old].set("name", new)
    for joint in tree.joints.values():
        for end in ("parent", "child"):
            element = joint.find(end)
            if element is not None and element.get("link") == old:
                element.set("link", new)


def _free_name(wanted: str, taken: Mapping[str, object]) -> str:
    while wanted in taken:
        wanted += "_"
    return wanted


def absolute_meshes(root: ET.Element, folder: Path) -> None:
    """Let relative mesh paths start at a folder."""
    for mesh in root.iter("mesh"):
        name = mesh.get("filename", "")
        if name and "://" not in name:
            mesh.set("filename", (folder / name).resolve().as_uri())


def _lock(tree: Tree, locked: Mapping[str, float]) -> None:
    moving = [name for name, joint in tree.joints.items() if kind_of(joint) in MOVING]
    check_joint_names(list(locked), moving, "locked_joints")
    positions = dict(locked)
    # A follower may follow a follower, in any order in the file.
    followers = {name: mimic for name, joint in tree.joints.items() if (mimic := mimic_of(name, joint)) is not None}
    positions = {name: mimic.offset for name, mimic in followers.items() if mimic.multiplier == 0.0} | positions
    while found := [n for n, mimic in followers.items() if n not in positions and mimic.joint in positions]:
        for name in found:
            mimic = followers[name]
            positions[name] = mimic.multiplier * positions[mimic.joint] + mimic.offset
    for name, position in positions.items():
        _fix(name, tree.joints[name], position)


def _fix(name: str, joint: ET.Element, position: float) -> None:
    if not math.isfinite(position):
        raise NonFiniteError("not a finite number", key=f"locked_joints.{name}", value=position)
    if position != 0.0:
        key = f"joint {name}"
        origin = joint.find("origin")
        placement = pin.SE3(
            pin.rpy.rpyToMatrix(numbers(origin, "rpy", "0 0 0", key)), numbers(origin, "xyz", "0 0 0", key)
        )
        placement = placement * _displacement(joint, key, position)
        origin = ET.SubElement(joint, "origin") if origin is None else origin
        origin.set("xyz", _text(placement.translation.tolist()))
        origin.set("rpy", _text(pin.rpy.matrixToRpy(placement.rotation).tolist()))
    joint.set("type", "fixed")
    for tag in ("axis", "limit", "mimic", "dynamics", "safety_controller", "calibration"):
        for element in joint.findall(tag):
            joint.remove(element)


def _displacement(joint: ET.Element, key: str, position: float) -> pin.SE3:
    axis = axis_of(joint, key)
    if kind_of(joint) == "prismatic":
        return pin.SE3(np.eye(3), axis * position)
    return pin.SE3(pin.AngleAxis(position, axis).toRotationMatrix(), np.zeros(3))


def _override_limits(tree: Tree, overrides: Mapping[str, JointLimits]) -> None:
    moving = [name for name, joint in tree.joints.items() if kind_of(joint) in MOVING]
    check_joint_names(list(overrides), moving, "joint_limits")
    for name, limits in overrides.items():
        joint = tree.joints[name]
        given = {key: value for key, value in limits.model_dump().items() if value is not None}
        if kind_of(joint) == "continuous" and ("lower" in given) != ("upper" in given):
            raise SpecError("a continuous joint gets both limits or none", key=f"joint_limits.{name}", value=given)
        if kind_of(joint) == "continuous" and "lower" in given:
            joint.set("type", "revolute")
        limit = joint.find("limit")
        limit = ET.SubElement(joint, "limit", effort="0", velocity="0") if limit is None else limit
        for key, value in given.items():
            limit.set(key, repr(value))


def _text(values: tuple[float, ...] | list[float]) -> str:
    return " ".join(repr(float(value)) for value in values)
