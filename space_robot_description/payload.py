"""A rigid payload in the hand: its mass and inertia join those of the body that holds it."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pinocchio as pin
from pydantic import Field

from space_robot_description.inertia import check_inertia
from space_robot_description.robot import Robot
from space_robot_description.robot_spec import InertiaInput, Pose, tensor
from space_robot_description.spec import Strict, Three
from space_robot_description.validation import nearest
from space_robot_msgs_py.errors import SpecError


class Payload(Strict):
    """A rigid body fixed to the robot."""

    mass: float = Field(description="[kg]")
    com: Three = Field(default=(0.0, 0.0, 0.0), description="centre of mass in the payload's frame [m]")
    inertia: InertiaInput = Field(
        default=(0.0, 0.0, 0.0),
        description="about its centre of mass, axes of its frame [kg m2]: [Ixx, Iyy, Izz], or those and Ixy, Ixz, Iyz, "
        "or a mapping ixx..iyz; zero: a point mass",
    )
    frame: str = Field(
        default="tool",
        description="link or joint that holds it; `tool` is the end of the arm, of several arms a tool by its name",
    )
    pose: Pose = Field(default_factory=Pose, description="the payload's frame in the holding frame")


def known_part(payload: Payload, fraction: float) -> Payload:
    """The nominal payload of which a fraction of mass and inertia is known, and where its centre is.

    Args:
        payload: the real one.
        fraction: above 0, usually up to 1.
    """
    inertia = tuple(fraction * moment for moment in _entries(payload.inertia))
    return payload.model_copy(update={"mass": fraction * payload.mass, "inertia": inertia})


def attach_payload(robot: Robot, payload: Payload) -> Robot:
    """The robot with the payload's inertia added to the body that holds it.

    Args:
        robot: it is not changed.
        payload: what is held.

    Returns:
        A robot with a model of its own; its URDF does not show the payload.

    Raises:
        SpecError: no such frame (with the nearest names).
        InertiaError: the payload cannot exist (mass not positive, triangle inequality, ...).

    Reference:
        Parallel-axis theorem, e.g. Featherstone (2008), "Rigid Body Dynamics Algorithms", (2.63).
    """
    joint, inertia = held_body(robot, payload)
    model = robot.model.copy()
    model.inertias[joint] = model.inertias[joint] + inertia
    return dataclasses.replace(robot, model=model)


def held_body(robot: Robot, payload: Payload) -> tuple[int, Any]:
    """Index of the joint that moves a payload, and the payload's ``pin.Inertia`` in the frame of that joint.

    Raises:
        SpecError: no such frame (with the nearest names).
        InertiaError: the payload cannot exist (mass not positive, triangle inequality, ...).
    """
    inertia, com = tensor(payload.inertia, "payload.inertia"), np.array(payload.com)
    check_inertia("payload", payload.mass, com, inertia, point_mass=True)
    joint, placement = _holder(robot, payload.frame)
    placement = placement * pin.SE3(pin.rpy.rpyToMatrix(np.array(payload.pose.rpy)), np.array(payload.pose.xyz))
    return joint, placement.act(pin.Inertia(payload.mass, com, inertia))


def _entries(inertia: InertiaInput) -> tuple[float, ...]:
    return tuple(tensor(inertia, "payload.inertia")[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]].tolist())


def _holder(robot: Robot, frame: str) -> tuple[int, pin.SE3]:
    """Index of the moving joint and the frame's place in it; a link wins over a joint of the same name."""
    model: Any = robot.model
    name = robot.tool_frame if frame == "tool" and robot.tool_frame else robot.tools.get(frame, frame)
    found = [item for item in model.frames if item.name == name and item.type != pin.FrameType.OP_FRAME]
    found.sort(key=lambda item: item.type != pin.FrameType.BODY)
    if not found or found[0].parentJoint == 0:
        names = [item.name for item in model.frames if item.parentJoint > 0]
        hint = nearest(frame, names) or ", ".join(names)
        raise SpecError("no such link or joint", key="payload.frame", value=frame, accepted=hint)
    return int(found[0].parentJoint), found[0].placement
