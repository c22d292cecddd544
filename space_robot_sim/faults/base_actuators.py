"""Faults of what turns and pushes the base: reaction wheels and thrusters."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field, NonNegativeFloat, NonNegativeInt

from space_robot_msgs_py.errors import SpecError
from space_robot_sim.faults.base import AXES, Actuation, ActuationFault, FaultSite, check_among

Factor = Annotated[float, Field(ge=0.0, le=1.0)]
# Columns of `Actuation.wheel_limit`.
TORQUE, MOMENTUM = 0, 1


class WheelFault(ActuationFault):
    """What all of them have: a wheel."""

    group: ClassVar[str] = "wheels"
    wheel: NonNegativeInt = Field(description="index of the wheel, from 0")

    @property
    def place(self) -> str:
        """The wheel."""
        return f"wheel{self.wheel}"

    def check(self, site: FaultSite, key: str) -> None:
        """Refuse a wheel that is not there."""
        if self.wheel >= site.wheels:
            accepted = f"0 to {site.wheels - 1}" if site.wheels else "a robot with reaction wheels"
            raise SpecError("no such wheel", key=f"{key}.wheel", value=self.wheel, accepted=accepted)


class WheelStopped(WheelFault):
    """The wheel seizes: within one period the body takes its momentum, and it takes and gives no more."""

    kind: Literal["wheel_stopped"] = "wheel_stopped"

    def act(self, now: Actuation, memory: dict[str, float]) -> None:
        """Stop within the period."""
        now.share[self.wheel] = 0.0
        now.wheel_limit[self.wheel, TORQUE] = 0.0
        now.push[self.wheel] = -now.wheels[self.wheel] / now.period


class WheelEffectiveness(WheelFault):
    """The wheel gives this part of its share of the torque, and of its limit."""

    kind: Literal["wheel_effectiveness"] = "wheel_effectiveness"
    factor: Factor = Field(description="of its torque [-]")

    def act(self, now: Actuation, memory: dict[str, float]) -> None:
        """Give less."""
        now.share[self.wheel] *= self.factor
        now.wheel_limit[self.wheel, TORQUE] *= self.factor


class WheelBias(WheelFault):
    """A torque turns the wheel that nothing commanded."""

    kind: Literal["wheel_bias"] = "wheel_bias"
    torque: float = Field(description="on the wheel; the body gets the opposite [N m]")

    def act(self, now: Actuation, memory: dict[str, float]) -> None:
        """Turn it."""
        now.push[self.wheel] += self.torque


class WheelFriction(WheelFault):
    """A drag slows the wheel down."""

    kind: Literal["wheel_friction"] = "wheel_friction"
    torque: NonNegativeFloat = Field(description="of the drag, at most what stops the wheel within a period [N m]")

    def act(self, now: Actuation, memory: dict[str, float]) -> None:
        """Slow it down."""
        stored = now.wheels[self.wheel]
        now.push[self.wheel] -= np.sign(stored) * min(self.torque, abs(stored) / now.period)


class WheelLimit(WheelFault):
    """The wheel is full earlier; what it has stored beyond stays in it."""

    kind: Literal["wheel_limit"] = "wheel_limit"
    momentum: NonNegativeFloat = Field(description="limit instead of the robot's, if smaller [N m s]")

    def act(self, now: Actuation, memory: dict[str, float]) -> None:
        """Be full."""
        limit = max(self.momentum, abs(now.wheels[self.wheel]))
        now.wheel_limit[self.wheel, MOMENTUM] = min(limit, now.wheel_limit[self.wheel, MOMENTUM])


class ThrusterFault(ActuationFault):
    """What all of them have: an axis of the base that is pushed from outside, by thrusters or an ideal torque."""

    group: ClassVar[str] = "thrusters"
    axis: Literal["force_x", "force_y", "force_z", "torque_x", "torque_y", "torque_z"] = Field(
        description="of the base, body frame"
    )

    @property
    def place(self) -> str:
        """The axis."""
        return self.axis

    def check(self, site: FaultSite, key: str) -> None:
        """Refuse an axis that nothing pushes."""
        check_among(self.axis, site.axes, "thruster", f"{key}.axis")

    @property
    def channel(self) -> int:
        """Which channel of a command it is."""
        return AXES.index(self.axis)


class ThrusterStuckOff(ThrusterFault):
    """Nothing is fired along this axis."""

    kind: Literal["thruster_stuck_off"] = "thruster_stuck_off"

    def act(self, now: Actuation, memory: dict[str, float]) -> None:
        """Fire nothing."""
        now.scale(self.channel, 0.0)


class ThrusterStuckOn(ThrusterFault):
    """Everything is fired along this axis in one direction, whatever is commanded."""

    kind: Literal["thruster_stuck_on"] = "thruster_stuck_on"
    direction: Literal[1, -1] = Field(default=1, description="1 or -1")

    def act(self, now: Actuation, memory: dict[str, float]) -> None:
        """Fire everything."""
        now.command[self.channel] = self.direction * now.limit[self.channel]


class ThrusterWeak(ThrusterFault):
    """The axis gives this part of what is commanded, and of its limit."""

    kind: Literal["thruster_weak"] = "thruster_weak"
    factor: Factor = Field(description="of the commanded force or torque [-]")

    def act(self, now: Actuation, memory: dict[str, float]) -> None:
        """Fire less."""
        now.scale(self.channel, self.factor)


class ThrusterLeaking(ThrusterFault):
    """A valve leaks: a constant force or torque beside what is commanded, without pulses."""

    kind: Literal["thruster_leaking"] = "thruster_leaking"
    level: float = Field(description="along the axis [N or N m]")

    def act(self, now: Actuation, memory: dict[str, float]) -> None:
        """Push."""
        now.outside[self.channel] += self.level
