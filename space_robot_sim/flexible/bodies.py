"""Appendages and tanks as joints that no motor drives, behind the joints of a robot."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import pi, radians
from typing import Any

import numpy as np
import pinocchio as pin

from space_robot_description.inertia import check_body, check_inertia
from space_robot_description.robot import Robot
from space_robot_description.robot_spec import tensor
from space_robot_description.validation import nearest
from space_robot_msgs_py.errors import InertiaError, SpecError
from space_robot_msgs_py.kernel.products import dot, norm, times
from space_robot_sim.flexible.spec import Appendage, FlexibilitySpec, Slosh, SpringBody

KEY = "plant.flexibility"
_SLIDES = {"x": pin.JointModelPX, "y": pin.JointModelPY, "z": pin.JointModelPZ}


@dataclass(frozen=True, eq=False, slots=True)
class HiddenJoint:
    """A joint that no motor drives and no sensor reads.

    Attributes:
        name: of it, in the telemetry.
        joint: its ``pin.JointModel``.
        place: where it stands in its link, or in the joint before.
        inertia: ``pin.Inertia`` of the body it moves, in its own frame; of several in a row the last has the mass.
        stiffness: of its spring [N m/rad or N/m].
        damping: beside it [N m s/rad or N s/m].
        start: its position at the start [rad or m].
    """

    name: str
    joint: Any
    place: Any
    inertia: Any
    stiffness: float
    damping: float
    start: float


@dataclass(frozen=True, eq=False, slots=True)
class HiddenBody:
    """An appendage or a tank.

    Attributes:
        key: of it in the file.
        spec: what the file says.
        joints: of it, each on the one before.
    """

    key: str
    spec: SpringBody
    joints: tuple[HiddenJoint, ...]

    @property
    def at_rest(self) -> Any:
        """Its ``pin.Inertia`` in the frame of its link, the spring relaxed."""
        place = pin.SE3.Identity()
        for joint in self.joints:
            place = place * joint.place
        return place.act(self.joints[-1].inertia)


def hidden_bodies(spec: FlexibilitySpec) -> tuple[HiddenBody, ...]:
    """Everything that swings.

    Raises:
        SpecError: a body turns without resistance.
        InertiaError: a body cannot exist.
    """
    panels = [(f"{KEY}.appendages.{k}", one) for k, one in enumerate(spec.appendages)]
    tanks = [(f"{KEY}.slosh.{k}", one) for k, one in enumerate(spec.slosh)]
    return (
        *(HiddenBody(key, one, (_hinged(one, key),)) for key, one in panels),
        *(HiddenBody(key, one, tuple(_sliding(one))) for key, one in tanks),
    )


def with_hidden(robot: Robot, bodies: Sequence[HiddenBody]) -> Any:
    """The ``pin.Model`` of the robot with hidden joints behind its own; at rest its mass matrix is the robot's.

    Args:
        robot: it is not changed.
        bodies: whose mass is taken out of their links, but for those that are ``added``.

    Raises:
        SpecError: a link is not there, or what remains of it cannot exist.
    """
    model = robot.model.copy()
    for body in bodies:
        parent, place = _link(robot, body)
        if not body.spec.added:
            _take_out(model, parent, place.act(body.at_rest), body)
        for joint in body.joints:
            parent = model.addJoint(parent, joint.joint, place * joint.place, f"{joint.name} (hidden)")
            model.appendBodyToJoint(parent, joint.inertia, pin.SE3.Identity())
            place = pin.SE3.Identity()
    return model


def _hinged(spec: Appendage, key: str) -> HiddenJoint:
    com, inertia = np.array(spec.com), tensor(spec.inertia, f"{key}.inertia")
    check_inertia(f"{spec.name} ({key})", spec.mass, com, inertia, point_mass=True)
    axis = np.array(spec.axis) / norm(np.array(spec.axis))
    arm = np.cross(axis, com)
    moment = dot(axis, times(inertia, axis)) + spec.mass * dot(arm, arm)
    if moment <= 0.0:
        accepted = "a centre of mass off the axis, or an inertia about it"
        raise SpecError(
            "nothing of it turns about its hinge", key=f"{key}.com", value=list(spec.com), accepted=accepted
        )
    joint, body = pin.JointModelRevoluteUnaligned(axis), pin.Inertia(spec.mass, com, inertia)
    place = pin.SE3(np.eye(3), np.array(spec.hinge))
    return HiddenJoint(spec.name, joint, place, body, *_spring(spec, moment), radians(spec.start_deg))


def _sliding(spec: Slosh) -> Iterator[HiddenJoint]:
    place, nothing = pin.SE3(np.eye(3), np.array(spec.at)), pin.Inertia(0.0, np.zeros(3), np.zeros((3, 3)))
    for axis in spec.axes:
        inertia = pin.Inertia(spec.mass, np.zeros(3), np.zeros((3, 3))) if axis == spec.axes[-1] else nothing
        start = spec.start["xyz".index(axis)]
        spring = _spring(spec, spec.mass)
        yield HiddenJoint(f"{spec.name}_{axis}", _SLIDES[axis](), place, inertia, *spring, start)
        place = pin.SE3.Identity()


def _spring(spec: SpringBody, inertia: float) -> tuple[float, float]:
    """Stiffness and damping of an oscillation of this inertia, its link being held."""
    omega = 2.0 * pi * spec.frequency
    return inertia * (omega * omega), 2.0 * spec.damping * omega * inertia


def _link(robot: Robot, body: HiddenBody) -> tuple[int, Any]:
    """Index of the joint that moves the link of a body, and the link's place in it."""
    model, name, key = robot.model, body.spec.link, f"{body.key}.link"
    frames = {frame.name: frame for frame in model.frames if frame.type == pin.FrameType.BODY and frame.parentJoint}
    if name in robot.body_names:
        joint, place = 1 + robot.body_names.index(name), pin.SE3.Identity()
    elif name in frames:
        joint, place = int(frames[name].parentJoint), frames[name].placement
    else:
        names = list(dict.fromkeys((*robot.body_names, *frames)))
        raise SpecError("no such link", key=key, value=name, accepted=nearest(name, names) or ", ".join(names))
    # Pinocchio's mass matrix needs bodies in depth-first order, and the hidden ones come last.
    if joint not in _last_branch(model):
        last = [one for k, one in enumerate(robot.body_names, start=1) if k in _last_branch(model)]
        raise SpecError("is not on the last branch of the robot", key=key, value=name, accepted=", ".join(last))
    return joint, place


def _last_branch(model: Any) -> set[int]:
    """The last joint of a model and all that carry it."""
    found, joint = {1}, model.njoints - 1
    while joint > 0:
        found.add(joint)
        joint = int(model.parents[joint])
    return found


def _take_out(model: Any, joint: int, inertia: Any, body: HiddenBody) -> None:
    left = model.inertias[joint].toDynamicParameters() - inertia.toDynamicParameters()
    name, accepted = body.spec.link, "less mass or inertia, or added: true"
    if left[0] <= 0.0:
        mass = float(model.inertias[joint].mass)
        raise SpecError(
            f"link {name} has {mass:g} kg in all", key=f"{body.key}.mass", value=body.spec.mass, accepted=accepted
        )
    remains = pin.Inertia.FromDynamicParameters(left)
    try:
        check_body(name, remains.mass, remains.lever, remains.inertia)
    except InertiaError as error:
        what = f"what remains of link {name} cannot exist: {error.message}"
        raise SpecError(what, key=body.key, value=body.spec.name, accepted=accepted) from None
    model.inertias[joint] = remains
