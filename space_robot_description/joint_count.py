"""How many joints a robot has, from its file and its URDFs alone: no model is made."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from space_robot_description.share import resource
from space_robot_msgs_py.bounded_files import read_bytes
from space_robot_msgs_py.bounded_xml import decode_xml, parse_xml
from space_robot_msgs_py.limits import URDF_BYTES

_FIXED = "fixed"


def count_joints(data: Mapping[str, Any], folder: Path) -> int:
    """The joints with a coordinate: those of the URDFs but fixed ones, those the file locks, and what follows others.

    Args:
        data: content of a robot file whose ``urdf``, or that of each of its ``arms``, names a URDF file.
        folder: where a relative path starts.

    Raises:
        SpaceRobotError: there is no such URDF, or it cannot be read.
    """
    locked = data.get("locked_joints", {})
    arms = data.get("arms", {"": data})
    return sum(
        (f"{arm}_{name}" if arm else name) not in locked
        for arm, section in arms.items()
        for name in _moving(resource(str(section["urdf"]), folder))
    )


def _moving(path: Path) -> Iterator[str]:
    root = parse_xml(decode_xml(read_bytes(path, URDF_BYTES), str(path)), str(path))
    for joint in root.findall("joint"):
        if joint.get("type") != _FIXED and joint.find("mimic") is None:
            yield joint.get("name", "")
