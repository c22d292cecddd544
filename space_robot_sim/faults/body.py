"""Faults of the body: payloads that come, go and shift, inertia that changes, a push from outside."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import ClassVar, Literal

import numpy as np
import pinocchio as pin
from pydantic import Field, PositiveFloat

from space_robot_description.payload import Payload, attach_payload
from space_robot_description.robot import Robot
from space_robot_description.spec import Three
from space_robot_msgs_py.errors import SpecError
from space_robot_sim.capture import TargetSpec
from space_robot_sim.faults.base import Actuation, ActuationFault, Fault, FaultSite, check_among


class BodyFault(Fault):
    """A fault after which another robot runs on: same joints and actuators, other inertias.

    But for what is caught, the motion goes on as it is, and the conservation baseline is reset.
    """

    group: ClassVar[str] = "body"

    def hold(self, held: Sequence[Payload]) -> tuple[Payload, ...]:
        """What is in the hand with this fault, of what would be without."""
        return tuple(held)

    def change(self, robot: Robot) -> Robot:
        """The robot with this fault, without what is in its hand."""
        return robot


class PayloadCaptured(BodyFault, TargetSpec):
    """The hand catches a free body in a plastic impact; the flight software does not know of it."""

    kind: Literal["payload_captured"] = "payload_captured"

    @property
    def place(self) -> str:
        """Where it is held."""
        return self.payload.frame

    def check(self, site: FaultSite, key: str) -> None:
        """Refuse a body that cannot exist, or a frame that is not there."""
        try:
            attach_payload(site.robot, self.payload)
        except ValueError as error:
            raise SpecError(f"cannot be held: {error}", key=f"{key}.payload") from None

    def hold(self, held: Sequence[Payload]) -> tuple[Payload, ...]:
        """One more."""
        return (*held, self.payload)


class PayloadLost(BodyFault):
    """Everything is lost that the hand held at its onset."""

    kind: Literal["payload_lost"] = "payload_lost"

    def check(self, site: FaultSite, key: str) -> None:
        """Refuse to lose nothing."""
        _check_held(site, key, "lose")

    def hold(self, held: Sequence[Payload]) -> tuple[Payload, ...]:
        """None."""
        return ()


class PayloadShifted(BodyFault):
    """What is in the hand has slipped."""

    kind: Literal["payload_shifted"] = "payload_shifted"
    offset: Three = Field(description="of its centre of mass, in the payload's frame [m]")

    def check(self, site: FaultSite, key: str) -> None:
        """Refuse to shift nothing."""
        _check_held(site, key, "shift")

    def hold(self, held: Sequence[Payload]) -> tuple[Payload, ...]:
        """The same with other centres of mass."""
        places = [tuple(map(sum, zip(one.com, self.offset, strict=True))) for one in held]
        return tuple(one.model_copy(update={"com": com}) for one, com in zip(held, places, strict=True))


class InertiaChange(BodyFault):
    """A body is heavier or lighter than it was: fuel gone, a part lost, an appendage deployed."""

    kind: Literal["inertia_change"] = "inertia_change"
    body: str = Field(description="`base_link`, or the body that a joint moves")
    factor: PositiveFloat = Field(description="of its mass and inertia [-]")
    shift: Three = Field(default=(0.0, 0.0, 0.0), description="of its centre of mass, in its own frame [m]")

    @property
    def place(self) -> str:
        """The body."""
        return self.body

    def check(self, site: FaultSite, key: str) -> None:
        """Refuse a body that is not there."""
        check_among(self.body, site.robot.body_names, "body", f"{key}.body")

    def change(self, robot: Robot) -> Robot:
        """A robot with a model of its own."""
        model, joint = robot.model.copy(), 1 + robot.body_names.index(self.body)
        was = model.inertias[joint]
        model.inertias[joint] = pin.Inertia(
            self.factor * was.mass, was.lever + np.array(self.shift), self.factor * was.inertia
        )
        return dataclasses.replace(robot, model=model)


class WrenchPulse(ActuationFault):
    """Something pushes the base: a jet, a cable, an impact spread over the window."""

    group: ClassVar[str] = "body"
    kind: Literal["wrench_pulse"] = "wrench_pulse"
    force: Three = Field(default=(0.0, 0.0, 0.0), description="at the base origin, body frame [N]")
    torque: Three = Field(default=(0.0, 0.0, 0.0), description="body frame [N m]")

    def check(self, site: FaultSite, key: str) -> None:
        """Refuse a push by nothing."""
        if not any((*self.force, *self.torque)):
            accepted = "a force or a torque that is not zero"
            raise SpecError("pushes nothing", key=f"{key}.force", value=list(self.force), accepted=accepted)

    def act(self, now: Actuation, memory: dict[str, float]) -> None:
        """Push."""
        now.outside += np.array([*self.force, *self.torque])


def _check_held(site: FaultSite, key: str, verb: str) -> None:
    if not site.holds_payload:
        accepted = "an experiment with plant.payload, plant.capture or a fault payload_captured before"
        raise SpecError(f"there is no payload to {verb}", key=key, accepted=accepted)
