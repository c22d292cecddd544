"""What is allowed in a robot and will probably go wrong in a run: a sentence each, before the run is lost."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pinocchio as pin

from space_robot_description.mass_matrix import coupling_condition
from space_robot_description.robot import Robot
from space_robot_description.spec import expand
from space_robot_description.urdf import Tree, kind_of, parse_urdf
from space_robot_description.urdf_values import to_float
from space_robot_description.visual import Look, look_of

# Beyond, an error of 1e-5 in a torque is one as large as the motion itself.
ILL_CONDITIONED = 1e5
# [rad or m] by which the rounded limits of two coupled joints may differ.
SLACK = 1e-3


def robot_warnings(robot: Robot) -> tuple[str, ...]:
    """What `space-robot robot` and `check` warn of.

    Args:
        robot: as loaded; deviations and payload are seen in its numbers, not in its looks.
    """
    tree = parse_urdf(robot.urdf, "urdf")
    return (*_conditioned(robot), *_unused_friction(robot, tree), *_beyond(robot, tree), *_too_wide(robot, tree))


def _conditioned(robot: Robot) -> Iterator[str]:
    condition = coupling_condition(robot.model, robot.home)
    if condition > ILL_CONDITIONED:
        yield (
            f"the reduced mass matrix is near singular at home: its condition is {condition:.3g}, above "
            f"{ILL_CONDITIONED:g}; small errors of a torque become large accelerations of light links"
        )


def _unused_friction(robot: Robot, tree: Tree) -> Iterator[str]:
    motors = robot.actuators.joints
    rubs = expand(motors.viscous, robot.joint_names, "viscous") + expand(motors.coulomb, robot.joint_names, "coulomb")
    unused = []
    for name, value in zip(robot.joint_names, rubs.tolist(), strict=True):
        dynamics = tree.joints[name].find("dynamics")
        asked = [0.0] if dynamics is None else [to_float(dynamics.get(key, "0")) for key in ("damping", "friction")]
        if value == 0.0 and max(asked) > 0.0:
            unused.append(f"{name} {max(asked):g}")
    if unused:
        where = "actuators.joints.viscous and coulomb"
        yield f"damping and friction of the URDF are not used ({', '.join(unused)}); say what there is in {where}"


def _beyond(robot: Robot, tree: Tree) -> Iterator[str]:
    """Followers that the range of the joint they follow takes beyond their own limits, which nothing keeps."""
    for name, mimic in robot.mimics.items():
        limit, master = tree.joints[name].find("limit"), robot.joint_names.index(mimic.joint)
        if limit is None or kind_of(tree.joints[name]) == "continuous":
            continue
        reached = [mimic.multiplier * end[master] + mimic.offset for end in (robot.joint_lower, robot.joint_upper)]
        lower, upper = (to_float(limit.get(end, "0")) for end in ("lower", "upper"))
        if min(reached) < lower - SLACK or max(reached) > upper + SLACK:
            yield (
                f"joint {name} follows {mimic.joint} from {min(reached):g} to {max(reached):g}, and its own limits are "
                f"{lower:g} to {upper:g}; what holds is joint_limits.{mimic.joint}"
            )


def _too_wide(robot: Robot, tree: Tree) -> Iterator[str]:
    """Bodies whose mass would have to be further out than anything that is drawn of them."""
    look = look_of(robot.urdf)
    whole = _drawn_whole(look, tree)
    for index, name in enumerate(robot.body_names, start=1):
        # As in the URDF: a payload or a deviation is nothing that is drawn.
        body = look.model.inertias[index]
        parts = [part for part in look.visuals.geometryObjects if part.parentJoint == index]
        if index not in whole or not parts or body.mass <= 0.0:
            continue
        radius = float(np.sqrt(np.max(np.linalg.eigvalsh(body.inertia)) / body.mass))
        reach = max(_farthest(part, body.lever) for part in parts)
        if radius > reach:
            yield (
                f"link {name}: its radius of gyration is {radius:.3g} m, and nothing of it is drawn further than "
                f"{reach:.3g} m from its centre of mass; see inertia.replace"
            )


def _drawn_whole(look: Look, tree: Tree) -> set[int]:
    """Joint indices of bodies of which every visual is there: a mesh that is missing has no size."""
    model: Any = look.model
    wanted: dict[int, int] = {}
    for name, link in tree.links.items():
        joint = int(model.frames[model.getFrameId(name, pin.FrameType.BODY)].parentJoint)
        wanted[joint] = wanted.get(joint, 0) + len(link.findall("visual"))
    there = [int(part.parentJoint) for part in look.visuals.geometryObjects]
    return {joint for joint, count in wanted.items() if there.count(joint) == count}


def _farthest(part: Any, centre: Any) -> float:
    """An upper bound of the distance of a drawn thing from a point of its body [m]."""
    part.geometry.computeLocalAABB()
    scale = float(np.max(np.abs(part.meshScale)))
    middle = part.placement.act(part.geometry.aabb_center * scale)
    return float(np.linalg.norm(middle - centre)) + float(part.geometry.aabb_radius) * max(scale, 1.0)
