"""A free body is caught: its motion, and the plastic impact with the hand that closes on it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple, Self

import numpy as np
import pinocchio as pin
from pydantic import Field, model_validator

from space_robot_description.kernel.linear import solve
from space_robot_description.mass_matrix import mass_matrix
from space_robot_description.payload import Payload, held_body
from space_robot_description.robot import Robot
from space_robot_description.spec import Strict, Three
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.products import dot, times


class TargetSpec(Strict):
    """A rigid body, and how it moves when the hand closes on it: by default it is at rest in inertial space."""

    payload: Payload = Field(description="the body, where the hand takes it")
    linear_velocity: Three = Field(
        default=(0.0, 0.0, 0.0), description="of its centre of mass before it is caught, inertial axes [m/s]"
    )
    angular_velocity: Three = Field(default=(0.0, 0.0, 0.0), description="before it is caught, inertial axes [rad/s]")
    attached: bool = Field(
        default=False,
        description="true: it appears at the velocity of the hand, without impact; the conservation baseline is reset",
    )

    @model_validator(mode="after")
    def _moves_or_is_attached(self) -> Self:
        if self.attached and any((*self.linear_velocity, *self.angular_velocity)):
            raise ValueError("attached: true, and a velocity of its own; accepted: one of them")
        return self


@dataclass(frozen=True, eq=False, slots=True)
class FreeBody:
    """A rigid body at the instant at which it becomes part of another one.

    Attributes:
        joint: index of the model's joint that moves the body that holds it.
        inertia: its ``pin.Inertia`` in the frame of that joint.
        linear_velocity: (3,) of its centre of mass, inertial axes [m/s].
        angular_velocity: (3,) inertial axes [rad/s].
    """

    joint: int
    inertia: Any
    linear_velocity: Three
    angular_velocity: Three


class RobotChange(NamedTuple):
    """Another robot runs on: the same joints and actuators, other inertias.

    Attributes:
        stamp: from when on [ns].
        robot: from then on.
        caught: the free body whose inertia is the difference; None: the motion goes on as it is, and the
            conservation baseline is reset.
    """

    stamp: int
    robot: Robot
    caught: FreeBody | None = None


class Impact(NamedTuple):
    """What an impact does.

    Attributes:
        velocity: (6+n,) of the robot after it.
        work: of the forces in the contact, never positive [J].
        momentum: (6,) linear and angular, about the inertial origin, that the free body brought [N s, N m s].
        energy: kinetic, that it brought [J].
    """

    velocity: Vector
    work: float
    momentum: Vector
    energy: float


def free_body(robot: Robot, target: TargetSpec) -> FreeBody | None:
    """The target as the robot takes it; None: it is attached.

    Raises:
        SpecError: the robot has no such frame, or the body cannot exist.
    """
    if target.attached:
        return None
    joint, inertia = held_body(robot, target.payload)
    return FreeBody(joint, inertia, target.linear_velocity, target.angular_velocity)


def catch(model: Any, q: Vector, v: Vector, body: FreeBody) -> Impact:
    """A free body sticks to the body that takes it: plastic impact, motors give no impulse, momentum is conserved.

    The impulse (J M^-1 J^T + I^-1)^-1 (v_t - J v) acts on the robot of mass matrix M at the body of Jacobian J, its
    opposite on the target of spatial inertia I and twist v_t. Written with the mass matrix of both,
    M_c = M + J^T I J, it is M_c (v+ - v) = J^T I (v_t - J v), which a point mass, whose I is singular, passes, too.

    Args:
        model: ``pin.Model`` of the robot that holds the body.
        q: (7+n,) configuration.
        v: (6+n,) velocity before.
        body: what is caught.

    Reference:
        Featherstone (2008), "Rigid Body Dynamics Algorithms", sec. 11.7.
    """
    data = model.createData()
    pin.computeJointJacobians(model, data, q)
    mass = mass_matrix(model, q)
    # Its twist where the joint is, in the frame of the joint.
    place, own = data.oMi[body.joint], body.inertia
    linear, omega = np.array(body.linear_velocity), np.array(body.angular_velocity)
    at_joint = linear - np.cross(omega, times(place.rotation, own.lever))
    twist = pin.Motion(times(place.rotation.T, at_joint), times(place.rotation.T, omega))
    jacobian, spatial = pin.getJointJacobian(model, data, body.joint, pin.LOCAL), own.matrix()
    relative = twist.vector - times(jacobian, v)
    impulse = times(jacobian.T, times(spatial, relative))
    jump = solve(mass, impulse)
    work = 0.5 * (dot(impulse, jump) - dot(relative, times(spatial, relative)))
    momentum = place.act(own * twist).vector
    return Impact(v + jump, work, momentum, 0.5 * dot(twist.vector, times(spatial, twist.vector)))
