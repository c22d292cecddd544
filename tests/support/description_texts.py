"""Small robot files for the tests of the description package."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

BOX = '<inertial><mass value="2"/><inertia ixx="0.02" iyy="0.03" izz="0.04" ixy="0.001" ixz="0" iyz="0"/></inertial>'


def link(name: str, inside: str = BOX) -> str:
    """A link, by default with a consistent inertia of 2 kg."""
    return f'<link name="{name}">{inside}</link>'


def joint(name: str, parent: str, child: str, kind: str = "revolute", inside: str = "") -> str:
    """A joint 0.4 m along x about z with limits, unless ``inside`` brings its own."""
    inside = inside or '<axis xyz="0 0 1"/><limit lower="-2" upper="2" effort="7" velocity="3"/>'
    ends = f'<parent link="{parent}"/><child link="{child}"/>'
    return f'<joint name="{name}" type="{kind}">{ends}<origin xyz="0.4 0 0" rpy="0.1 0 0"/>{inside}</joint>'


def urdf(*parts: str) -> str:
    """A robot of these parts."""
    return f'<robot name="test">{"".join(parts)}</robot>'


TWO_LINKS = (
    link("base_link"),
    link("upper"),
    link("fore"),
    joint("j1", "base_link", "upper"),
    joint("j2", "upper", "fore"),
)


def robot_file(text: str = urdf(*TWO_LINKS), **changes: Any) -> dict[str, Any]:
    """Content of a robot file around URDF text: free-floating, ideal torque, 5 N m motors."""
    data: dict[str, Any] = {
        "name": "test",
        "urdf": text,
        "base_mode": "free_floating",
        "actuators": {"joints": {"effort": 5.0}, "base_torque": {"kind": "ideal", "limit": [1, 1, 1]}},
    }
    return data | changes


def actuators(**changes: Any) -> Mapping[str, Any]:
    """The actuators of `robot_file` with some sections replaced."""
    return {"joints": {"effort": 5.0}, "base_torque": {"kind": "ideal", "limit": [1, 1, 1]}} | changes
