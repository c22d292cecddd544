"""A robot file, a shipped name or a resolved mapping to a Robot: the one entry of the package."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

from space_robot_description.actuation import check_actuators
from space_robot_description.compose import compose_urdf
from space_robot_description.joint_row import JointRow
from space_robot_description.mass_matrix import check_invertible
from space_robot_description.mimic import read_mimics
from space_robot_description.model import build_model, end_of_arm, moving_links
from space_robot_description.robot import Robot
from space_robot_description.robot_spec import ArmSpec, RobotSpec, check_sources
from space_robot_description.several_arms import join_arms
from space_robot_description.share import config_dir, is_file, resource, shipped
from space_robot_description.spec import Actuators, expand
from space_robot_description.urdf import Tree, child_of, parse_urdf
from space_robot_description.validation import nearest, parse_yaml, validate
from space_robot_description.xacro_file import expand_xacro, is_xacro
from space_robot_msgs_py.bounded_files import read_bytes, short
from space_robot_msgs_py.bounded_xml import decode_xml
from space_robot_msgs_py.errors import InputFileError, SpecError
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.limits import URDF_BYTES


def load_robot(robot: str | Path | Mapping[str, Any]) -> Robot:
    """Make a robot.

    Args:
        robot: name of a shipped robot such as ``mini``, path of a robot file, or the content of one
            (``Robot.resolved``; relative URDF paths then start at the working directory).

    Raises:
        SpecError: unknown name (with the nearest ones), or something in the file or URDF cannot be used.
        InputFileError: a file is missing.
        InertiaError: a body cannot exist; the message names the link.
    """
    if isinstance(robot, Mapping):
        return robot_from_spec(validate(RobotSpec, dict(robot), "robot"), Path())
    path = robot_path(robot)
    return robot_from_spec(validate(RobotSpec, parse_yaml(path), str(robot)), path.parent)


def robot_path(name_or_path: str | Path) -> Path:
    """The file of a shipped robot, or the given path.

    Raises:
        SpecError: no shipped robot has that name, or it is a bare URDF.
        InputFileError: it looks like a path and there is no such file.
    """
    path = Path(name_or_path)
    if path.suffix in (".urdf", ".xacro"):
        accepted = f"a robot file with `urdf: {path.name}`, a base mode and actuators"
        raise SpecError("a URDF alone cannot be run", key="robot", value=short(name_or_path), accepted=accepted)
    if is_file(path):
        return path
    if path.suffix or len(path.parts) != 1:
        raise InputFileError("no such robot file", key="robot", value=short(name_or_path))
    names = shipped("robots")
    if path.name not in names:
        accepted = f"a robot file, or one of: {nearest(path.name, names) or ', '.join(names)}"
        raise SpecError("no shipped robot has this name", key="robot", value=short(path.name), accepted=accepted)
    return config_dir() / "robots" / f"{path.name}.yaml"


def robot_from_spec(spec: RobotSpec, folder: Path) -> Robot:
    """Compose, check and build.

    Args:
        spec: the robot file.
        folder: where relative URDF paths start.

    Raises:
        SpaceRobotError: see `load_robot`.
    """
    single, text, urdf_folder = _one_urdf(spec, folder)
    urdf, notes = compose_urdf(single, text, urdf_folder)
    tree = parse_urdf(urdf, f"{spec.name} urdf")
    model, rows = build_model(tree)
    names = tuple(rows)
    actuators = check_actuators(spec, names, [row.effort for row in rows.values()])
    home = _home(spec, rows)
    moved = (tree.root_link, *(child_of(tree.joints[name]) for name in names))
    check_invertible(model, np.concatenate([pin.neutral(model)[:7], home]), moved)
    return Robot(
        name=spec.name,
        urdf=urdf,
        model=model,
        joint_names=names,
        body_names=moving_links(tree, model),
        base_mode=spec.base_mode,
        actuators=actuators,
        effort_limit=expand(actuators.joints.effort, names, "actuators.joints.effort"),
        joint_lower=_column(rows, "lower"),
        joint_upper=_column(rows, "upper"),
        joint_rate_limit=_column(rows, "velocity"),
        home=home,
        tool_frame=_tool(single, tree),
        tools=_tools(single, tree),
        resolved=_resolved(single, urdf, actuators),
        notes=notes,
        mimics=read_mimics(tree),
    )


def _one_urdf(spec: RobotSpec, folder: Path) -> tuple[RobotSpec, str, Path | None]:
    """The robot file as one of a single URDF, that URDF, and where it lies."""
    check_sources(spec)
    if not spec.arms:
        return spec, *_urdf_text(spec, folder, "")
    texts = {name: _urdf_text(arm, folder, f"arms.{name}.") for name, arm in spec.arms.items()}
    text, tools = join_arms(spec, texts)
    tool = spec.tool or next(iter(tools.values()))
    done = {"urdf": text, "arms": {}, "base": None, "tool": tool, "tools": tools | spec.tools}
    return spec.model_copy(update=done), text, None


def _urdf_text(spec: RobotSpec | ArmSpec, folder: Path, key: str) -> tuple[str, Path | None]:
    inside = spec.urdf.lstrip().startswith("<")
    if spec.xacro_args and (inside or not is_xacro(spec.urdf)):
        value = "URDF text" if inside else short(spec.urdf)
        raise SpecError(
            "only a xacro file has arguments", key=f"{key}xacro_args", value=value, accepted="urdf: FILE.xacro"
        )
    if inside:
        return spec.urdf, None
    path = resource(spec.urdf, folder)
    where = f"urdf {short(path)}"
    data = expand_xacro(path, spec.xacro_args) if is_xacro(spec.urdf) else read_bytes(path, URDF_BYTES, where)
    return decode_xml(data, where), path.parent


def _column(rows: Mapping[str, JointRow], field: str) -> Vector:
    # Limits may be infinite, so this is no `vector`, but as read-only.
    out = np.array([getattr(row, field) for row in rows.values()], dtype=np.float64)
    out.flags.writeable = False
    return out


def _home(spec: RobotSpec, rows: Mapping[str, JointRow]) -> Vector:
    nearest_to_0 = [min(max(0.0, row.lower), row.upper) for row in rows.values()]
    home = expand(spec.home, tuple(rows), "home", default=nearest_to_0)
    stands = dict(zip(rows, home.tolist(), strict=True))
    outside = {name: row for name, row in rows.items() if not row.lower <= stands[name] <= row.upper}
    if len(outside) == 1:
        name, row = next(iter(outside.items()))
        accepted = f"{row.lower:g}..{row.upper:g}"
        raise SpecError("home is outside the joint limits", key=f"home.{name}", value=stands[name], accepted=accepted)
    if outside:
        value = ", ".join(f"{name} {stands[name]:g}" for name in outside)
        accepted = ", ".join(f"{name} {row.lower:g}..{row.upper:g}" for name, row in outside.items())
        raise SpecError("home is outside the joint limits", key="home", value=value, accepted=accepted)
    return home


def _tool(spec: RobotSpec, tree: Tree) -> str:
    if spec.tool is None:
        return end_of_arm(tree)
    if spec.tool not in tree.links:
        accepted = nearest(spec.tool, tree.links) or ", ".join(tree.links)
        raise SpecError("no such link", key="tool", value=spec.tool, accepted=accepted)
    return spec.tool


def _tools(spec: RobotSpec, tree: Tree) -> dict[str, str]:
    for name, link in spec.tools.items():
        if link not in tree.links:
            accepted = nearest(link, tree.links) or ", ".join(tree.links)
            raise SpecError("no such link", key=f"tools.{name}", value=link, accepted=accepted)
    return dict(spec.tools)


def _resolved(spec: RobotSpec, urdf: str, actuators: Actuators) -> dict[str, Any]:
    """The file whose URDF holds base, locks, limits and inertias: nothing else is needed to make the robot again."""
    done: dict[str, Any] = {"urdf": urdf, "base": None, "locked_joints": {}, "joint_limits": {}, "actuators": actuators}
    return spec.model_copy(update=done).model_dump(mode="json", exclude={"inertia", "xacro_args"})
