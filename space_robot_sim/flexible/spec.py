"""What an experiment may say of the flexibility of the real robot; apart from the kernel, as checking compiles none."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, PositiveFloat, model_validator

from space_robot_description.robot_spec import InertiaInput
from space_robot_description.spec import PerJoint, Strict, Three
from space_robot_msgs_py.limits import NAME_LENGTH

Name = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]*$", max_length=NAME_LENGTH.most)]
# A ratio of 1 is no oscillation; beyond it the frequency means nothing.
Ratio = Annotated[float, Field(ge=0.0, lt=1.0)]
Axis = Literal["x", "y", "z"]
# Hidden coordinates cost time like joints.
MAX_BODIES = 16


class SpringBody(Strict):
    """A body on a spring: where it is fixed, and how it swings while its link is held."""

    name: Name = Field(description="what it is called in the telemetry")
    link: str = Field(default="base_link", description="link it is fixed to")
    mass: PositiveFloat = Field(description="[kg]")
    frequency: PositiveFloat = Field(description="of its oscillation while the link is held [Hz]")
    damping: Ratio = Field(default=0.005, description="ratio of the same oscillation [-]")
    added: bool = Field(
        default=False, description="false: the robot file's link has this mass in it; true: it comes on top"
    )


class Appendage(SpringBody):
    """A panel, boom or antenna on a hinge with spring and damper: one mode of bending or torsion."""

    hinge: Three = Field(default=(0.0, 0.0, 0.0), description="point of the hinge in the link's frame [m]")
    axis: Three = Field(description="of the hinge, axes of the link; any length but zero")
    com: Three = Field(description="centre of mass from the hinge, axes of the link [m]")
    inertia: InertiaInput = Field(
        default=(0.0, 0.0, 0.0), description="about its centre of mass, axes of the link [kg m2], as of a payload"
    )
    start_deg: float = Field(default=0.0, ge=-90.0, le=90.0, description="deflection at the start [deg]")

    @model_validator(mode="after")
    def _has_axis(self) -> Self:
        if not any(self.axis):
            raise ValueError("axis: a hinge needs one that is not zero")
        return self


class Slosh(SpringBody):
    """Fuel that sloshes: a point mass on springs; in free fall a pendulum has nothing that brings it back."""

    at: Three = Field(description="where it rests, in the link's frame [m]")
    axes: Annotated[tuple[Axis, ...], Field(min_length=1, max_length=3)] = Field(
        default=("x", "y", "z"), description="of the link along which it moves"
    )
    start: Three = Field(default=(0.0, 0.0, 0.0), description="displacement at the start along x, y, z [m]")

    @model_validator(mode="after")
    def _once_each(self) -> Self:
        if len(set(self.axes)) != len(self.axes):
            raise ValueError(f"axes: each once, not {', '.join(self.axes)}")
        still = [axis for axis, shift in zip("xyz", self.start, strict=True) if shift and axis not in self.axes]
        if still:
            raise ValueError(f"start: it does not move along {still[0]}")
        return self


class JointFlexibility(Strict):
    """Gears that twist: a motor behind its gear, a spring with damper, the link."""

    stiffness: PerJoint = Field(description="between motor and link [N m/rad]; joints not named are rigid")
    damping: PerJoint = Field(default=0.0, description="beside the stiffness [N m s/rad]")
    rotor_inertia: PerJoint = Field(description="of the motor about its own axis, before the gear [kg m2]")
    gear_ratio: PerJoint = Field(default=1.0, description="turns of the motor per turn of the joint [-]")
    measured: Literal["link", "motor"] = Field(
        default="link", description="where joint position and rate are read; motor: angle of the motor over the ratio"
    )


class FlexibilitySpec(Strict):
    """What is flexible in the real robot and unknown to every law."""

    appendages: Annotated[tuple[Appendage, ...], Field(max_length=MAX_BODIES)] = Field(
        default=(), description="panels, booms and antennas on hinges with springs"
    )
    slosh: Annotated[tuple[Slosh, ...], Field(max_length=MAX_BODIES)] = Field(
        default=(), description="fuel that moves on springs"
    )
    joints: JointFlexibility | None = Field(default=None, description="gears that twist")

    @model_validator(mode="after")
    def _names_something(self) -> Self:
        names = [one.name for one in self.appendages]
        names += [f"{one.name}_{axis}" for one in self.slosh for axis in one.axes]
        if not names and self.joints is None:
            raise ValueError("appendages, slosh or joints is missing; without any leave flexibility out")
        if len(set(names)) != len(names):
            double = next(name for name in names if names.count(name) > 1)
            raise ValueError(f"name: {double} is there twice; each appendage, and each tank_axis, has its own")
        return self
