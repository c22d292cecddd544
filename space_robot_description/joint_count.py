"""How many joints a robot has, from its file and its URDF alone: no model is made."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from space_robot_description.share import resource
from space_robot_msgs_py.bounded_files import read_bytes
from space_robot_msgs_py.bounded_xml import decode_xml, parse_xml
from space_robot_msgs_py.limits import URDF_BYTES

_FIXED = "fixed"


def count_joints(data: Mapping[str, Any], folder: Path) -> int:
    """The joints that move: those of the URDF but the fixed ones, those the file locks, and what follows these.

    Args:
        data: content of a robot file whose ``urdf`` names a URDF file.
        folder: where a relative path starts.

    Raises:
        SpaceRobotError: there is no such URDF, or it cannot be read.
    """
    path = resource(str(data["urdf"]), folder)
    root = parse_xml(decode_xml(read_bytes(path, URDF_BYTES), str(path)), str(path))
    locked = data.get("locked_joints", {})
    moving = [joint for joint in root.findall("joint") if joint.get("type") != _FIXED]
    # What follows a joint that is not locked is refused where the robot is made.
    return sum(joint.get("name") not in locked and joint.find("mimic") is None for joint in moving)
