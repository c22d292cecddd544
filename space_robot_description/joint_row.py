"""One moving joint of a URDF: its axis and limits, or why it cannot be one coordinate."""

from __future__ import annotations

import math
from dataclasses import dataclass
from xml.etree import ElementTree as ET

from space_robot_description.urdf import MOVING, kind_of
from space_robot_description.urdf_values import axis_of, number, placement_of
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Vector


@dataclass(frozen=True, eq=False, slots=True)
class JointRow:
    """One moving joint of the URDF.

    Attributes:
        axis: (3,) unit axis in the joint frame.
        lower: [rad or m], -inf for continuous.
        upper: [rad or m], +inf for continuous.
        velocity: [rad/s or m/s], +inf if absent or 0.
        effort: [N m or N], 0 if absent.
        prismatic: it slides along the axis; else it turns about it.
    """

    axis: Vector
    lower: float
    upper: float
    velocity: float
    effort: float
    prismatic: bool


def read_joint(name: str, joint: ET.Element) -> JointRow | None:
    """The row of a joint; None if it is fixed.

    Raises:
        SpecError: it cannot be a single coordinate, or its limits are none.
    """
    key = f"joint {name}"
    kind = kind_of(joint)
    placement_of(joint, key)
    if kind == "fixed":
        return None
    if kind not in MOVING:
        hint = "; the root link is free by itself, drop this joint" if kind == "floating" else ""
        raise SpecError("joint type cannot be used", key=key, value=kind, accepted=f"fixed, {', '.join(MOVING)}{hint}")
    limit = joint.find("limit")
    # A follower has the limits of the joint it follows; its own ones say nothing new, or what the two cannot do.
    follows = limit is None and joint.find("mimic") is not None
    limits = (-math.inf, math.inf, math.inf, 0.0) if follows else _limits(name, kind, limit)
    return JointRow(axis_of(joint, key), *limits, prismatic=kind == "prismatic")


def _limits(name: str, kind: str, limit: ET.Element | None) -> tuple[float, float, float, float]:
    key, advice = f"joint {name}", f"joint_limits: {{{name}: {{lower: -1.5, upper: 1.5}}}} in the robot file"
    if limit is None:
        if kind == "continuous":
            return -math.inf, math.inf, math.inf, 0.0
        accepted = f"<limit lower= upper= effort= velocity=>, or {advice}"
        raise SpecError(f"{kind} joint without <limit>", key=key, accepted=accepted)
    velocity, effort = number(limit, "velocity", key) or math.inf, number(limit, "effort", key) or 0.0
    if velocity < 0.0 or effort < 0.0:
        raise SpecError("limit is negative", key=key, value=f"velocity {velocity}, effort {effort}", accepted=">= 0")
    if kind == "continuous":
        return -math.inf, math.inf, velocity, effort
    lower, upper = number(limit, "lower", key) or 0.0, number(limit, "upper", key) or 0.0
    if not lower < upper:
        accepted = f"lower < upper, e.g. by {advice}"
        raise SpecError("limits are not in order", key=key, value=[lower, upper], accepted=accepted)
    return lower, upper, velocity, effort
