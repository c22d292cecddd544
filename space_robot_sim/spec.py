"""What an experiment may say about the plant; apart from the kernel, so that checking a file compiles nothing."""

from __future__ import annotations

from typing import Annotated, Any, Literal

import numpy as np
import numpy.typing as npt
from pydantic import (
    AfterValidator,
    Field,
    NonNegativeFloat,
    PositiveFloat,
    PositiveInt,
    SerializerFunctionWrapHandler,
    model_serializer,
)

from space_robot_description.spec import Strict, Three
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import NANOSECONDS

# In one control period, fixed or adaptive; the kernel's own bound, whose module needs the compiler.
MAX_STEPS = 20_000
STEP_KEY = "plant.integrator.step"
_MAX_STEP = {"dop853": 0.05, "rk4": 0.005}
# Largest product of the fastest eigenvalue of a flexible robot and a step.
RESOLVED = {"dop853": 0.5, "rk4": 0.1}


class IntegratorSpec(Strict):
    """Integration of the true robot."""

    kind: Literal["auto", "dop853", "dop853_adaptive", "rk4"] = Field(
        default="auto",
        description="auto: dop853 in fixed steps, each repeated in shorter ones where it misses the tolerance, "
        "dop853_adaptive where a motor has lag or friction",
    )
    step: PositiveFloat | None = Field(
        default=None, description="longest fixed step [s]; default 0.05 (dop853), 0.005 (rk4)"
    )
    rtol: PositiveFloat = Field(default=1e-9, description="relative tolerance of a step")
    atol: PositiveFloat = Field(default=1e-12, description="absolute tolerance of a step [SI units]")
    kernel: Literal["auto", "numba", "pinocchio"] = Field(
        default="auto", description="auto: compiled where numba is installed, over pinocchio where not"
    )


def method(spec: IntegratorSpec, *, rough: bool) -> str:
    """The kind of integration that ``auto`` stands for; ``rough``: a motor has lag or friction."""
    if spec.kind != "auto":
        return spec.kind
    return "dop853_adaptive" if rough else "dop853"


def fixed_steps(spec: IntegratorSpec, kind: str, period: int, fastest: float = 0.0) -> int:
    """Number of equal steps in a control period [ns] of an integration in fixed steps.

    Args:
        spec: what the file says.
        kind: dop853 or rk4.
        period: control period [ns].
        fastest: largest eigenvalue of the modes of a flexible robot [1/s], which a step has to resolve.

    Raises:
        SpecError: they would not be whole nanoseconds, there would be too many, or one resolves no mode.
    """
    seconds, longest = period / NANOSECONDS, spec.step or _MAX_STEP[kind]
    if fastest * longest > RESOLVED[kind]:
        return _resolving(spec, kind, period, fastest)
    # The margin lets 0.1 s be two steps of 0.05 s whatever the rounding of the quotient.
    steps = max(1.0, np.ceil(seconds / longest - 1e-9))
    if steps > MAX_STEPS:
        accepted = f"at least {seconds / MAX_STEPS:g} s, which is {MAX_STEPS} steps in a control period"
        raise SpecError("too short", key=STEP_KEY, value=longest, accepted=accepted)
    if period % int(steps):
        raise SpecError(
            f"a control period of {period} ns does not divide into {steps:.0f} equal steps",
            key=STEP_KEY,
            value=longest,
            accepted="a step that divides the control period into whole nanoseconds",
        )
    return int(steps)


def _resolving(spec: IntegratorSpec, kind: str, period: int, fastest: float) -> int:
    """Number of equal steps that resolve the fastest mode, where the file does not say how long they are."""
    longest, mode = RESOLVED[kind] / fastest, fastest / (2.0 * np.pi)
    if spec.step is not None:
        what = f"does not resolve the fastest mode of plant.flexibility, {mode:.4g} Hz"
        accepted = f"at most {longest:.4g} s, or no step: one is chosen"
        raise SpecError(what, key=STEP_KEY, value=spec.step, accepted=accepted)
    least = int(np.ceil(min(period / NANOSECONDS / longest, 2.0 * MAX_STEPS)))
    found = next((count for count in range(least, MAX_STEPS + 1) if period % count == 0), None)
    if found is None:
        slowest = RESOLVED[kind] * MAX_STEPS * NANOSECONDS / period / (2.0 * np.pi)
        accepted = f"softer springs or more mass, up to about {slowest:.4g} Hz at this control period"
        raise SpecError(
            "the fastest mode is too fast", key="plant.flexibility", value=f"{mode:.4g} Hz", accepted=accepted
        )
    return found


def _not_negative(value: float | tuple[float, ...]) -> float | tuple[float, ...]:
    if np.min(value, initial=0.0) < 0.0:
        raise ValueError("must not be negative")
    return value


Size = Annotated[float | tuple[float, ...], AfterValidator(_not_negative)]


class ChannelSpec(Strict):
    """One measured vector; noise, bias and quantisation are one number, or one per component."""

    noise: Size = Field(default=0.0, description="standard deviation of every sample, white")
    bias: float | tuple[float, ...] = Field(default=0.0, description="constant offset")
    quantisation: Size = Field(default=0.0, description="the reading is a multiple of this; 0: continuous")
    delay: NonNegativeFloat = Field(default=0.0, description="age of the reading [s], whole control periods")

    @property
    def ideal(self) -> bool:
        """True if the truth passes unchanged."""
        sizes = self.noise, self.bias, self.quantisation
        return not (any(any(one) if isinstance(one, tuple) else one for one in sizes) or self.delay)


class HoldFor(Strict):
    """What acts when no usable command is there: the last one for some periods, then nothing."""

    last_for: PositiveInt = Field(description="control periods without a usable command in which the last one acts")
    brakes: bool = Field(default=False, description="then the joints' brakes close, until a usable command is there")

    @model_serializer(mode="wrap")
    def _without_what_is_not(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        return {key: value for key, value in handler(self).items() if key != "brakes" or value}


Hold = Literal["last", "zero"] | HoldFor


class CommandCheck(Strict):
    """One check of commands and what is done with what does not pass."""

    factor: PositiveFloat = Field(description="over the limit of each actuator [-]")
    response: Literal["refuse", "clip"] = Field(
        default="refuse", description="refuse: the hold acts; clip: as much of it as passes, channel by channel"
    )


class MonitorSpec(Strict):
    """What the plant checks of commands that fit the robot; what it finds is published on `plant/events`."""

    limit: CommandCheck | None = Field(default=None, description="size of a command")
    rate: CommandCheck | None = Field(
        default=None, description="change since the command that was taken last, per control period since then"
    )


class DisturbanceSpec(Strict):
    """What pushes the base at all times beside its actuators, unknown to every law: drag, solar pressure, a leak."""

    force: Three = Field(default=(0.0, 0.0, 0.0), description="constant in inertial axes [N]")
    at: Three = Field(default=(0.0, 0.0, 0.0), description="where it acts, in base_link: the centre of pressure [m]")
    torque: Three = Field(default=(0.0, 0.0, 0.0), description="beside the force's, constant in base_link [N m]")

    @property
    def numbers(self) -> npt.NDArray[np.float64]:
        """(9,) as kernels know it."""
        return np.array([*self.force, *self.at, *self.torque])


class SensorSpec(Strict):
    """All channels; each is ideal until something is said about it, that of the wheels absent."""

    position: ChannelSpec = Field(default_factory=ChannelSpec, description="base position [m]")
    attitude: ChannelSpec = Field(default_factory=ChannelSpec, description="small rotation of the body frame [rad]")
    linear_velocity: ChannelSpec = Field(default_factory=ChannelSpec, description="body frame [m/s]")
    angular_velocity: ChannelSpec = Field(default_factory=ChannelSpec, description="body frame [rad/s]")
    joint_position: ChannelSpec = Field(default_factory=ChannelSpec, description="[rad or m]")
    joint_velocity: ChannelSpec = Field(default_factory=ChannelSpec, description="[rad/s or m/s]")
    acceleration: ChannelSpec = Field(default_factory=ChannelSpec, description="base origin, body frame [m/s2]")
    wheel_momentum: ChannelSpec | None = Field(
        default=None,
        description="of the reaction wheels, sum over their axes, body frame [N m s]; {}: ideal; null: not measured",
    )

    @model_serializer(mode="wrap")
    def _without_what_is_not(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        # The log of a run without wheel readings is, to the byte, what it was before there were any.
        return {key: value for key, value in handler(self).items() if key != "wheel_momentum" or value is not None}
