"""References of an experiment file: one typed model per kind, selected by ``kind``."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import (
    Field,
    NonNegativeFloat,
    NonNegativeInt,
    PositiveFloat,
    SerializerFunctionWrapHandler,
    model_serializer,
    model_validator,
)

from space_robot_description.spec import PerJoint, Strict, Three

Four = Annotated[tuple[float, ...], Field(min_length=4, max_length=4)]
JointTargets = tuple[float, ...] | dict[str, float]
Rows = tuple[tuple[float, ...], ...]


class Target(Strict):
    """A configuration to go to; what is left out stays where the motion before it ended (at first: the initial one)."""

    position: Three | None = Field(default=None, description="base origin in the inertial frame [m]")
    attitude_deg: Three | None = Field(default=None, description="roll, pitch, yaw of the base, R = Rz Ry Rx [deg]")
    quaternion: Four | None = Field(default=None, description="the same as x, y, z, w, of any length but zero [-]")
    joints: JointTargets | None = Field(default=None, description="a list, or a mapping by joint name [rad or m]")
    joints_deg: JointTargets | None = Field(default=None, description="the same in degrees [deg]")
    joints_by_deg: PerJoint | None = Field(
        default=None, description="how far to move: one number for all joints, a list or a mapping by name [deg]"
    )

    @model_validator(mode="after")
    def _said_once(self) -> Self:
        for ways in (("attitude_deg", "quaternion"), ("joints", "joints_deg", "joints_by_deg")):
            given = [way for way in ways if getattr(self, way) is not None]
            if len(given) > 1:
                raise ValueError(f"give {' or '.join(given)}, not both")
        return self


class HoldSpec(Target):
    """Stay at the initial or the given configuration."""

    kind: Literal["hold"] = "hold"


class StepSpec(Target):
    """Stay at the initial configuration, from one time on at the given one: a jump."""

    kind: Literal["step"] = "step"
    time: NonNegativeFloat = Field(default=0.0, description="when the target becomes the reference [s]")


class QuinticSpec(Target):
    """From rest to rest: position on a straight line, attitude on the geodesic, joints together, quintic in time."""

    kind: Literal["quintic"] = "quintic"
    start: NonNegativeFloat = Field(default=0.0, description="when the motion starts [s]")
    duration: PositiveFloat = Field(description="how long it takes [s]")


class Wave(Strict):
    """amplitude * sin(2 pi frequency t + phase), t since the start of the reference."""

    amplitude: float | None = Field(default=None, description="[rad or m]")
    amplitude_deg: float | None = Field(default=None, description="the same in degrees, for angles [deg]")
    frequency: PositiveFloat = Field(description="[Hz]")
    phase_deg: float = Field(default=0.0, description="[deg]")

    @model_validator(mode="after")
    def _one_amplitude(self) -> Self:
        if (self.amplitude is None) == (self.amplitude_deg is None):
            raise ValueError("give amplitude or amplitude_deg, one of them")
        return self


Waves = Wave | tuple[Wave, ...]
WAVE = Field(default=(), description="one wave, or a list whose sum it is")


class HarmonicSpec(Strict):
    """Waves about a configuration, grown from rest by a C2 ramp: excitation for identification.

    Base angles are roll, pitch, yaw (R = Rz Ry Rx); body rates and accelerations follow from them exactly.
    """

    kind: Literal["harmonic"] = "harmonic"
    start: NonNegativeFloat = Field(default=0.0, description="when the waves start [s]")
    soft_start: PositiveFloat = Field(default=10.0, description="duration of the ramp from rest to full amplitude [s]")
    center: Target = Field(default_factory=Target, description="configuration the waves move about")
    x: Waves = WAVE
    y: Waves = WAVE
    z: Waves = WAVE
    roll: Waves = WAVE
    pitch: Waves = WAVE
    yaw: Waves = WAVE
    joints: dict[str, Waves] | tuple[Waves, ...] = Field(
        default=(), description="mapping by joint name, or a list in joint order (an empty list: that joint rests)"
    )


class Waypoint(Target):
    """A configuration and when to be there."""

    time: NonNegativeFloat = Field(description="[s], later than the waypoint before")


class WaypointsSpec(Strict):
    """Through a list of configurations; it starts at the initial one at time 0 unless the first waypoint has time 0."""

    kind: Literal["waypoints"] = "waypoints"
    points: tuple[Waypoint, ...] = Field(min_length=1)
    interpolation: Literal["quintic", "spline"] = Field(
        default="quintic",
        description="quintic: stop at each; spline: position and joints pass smoothly, the attitude stops at each",
    )


class ToolTarget(Strict):
    """Where the tool frame is to be, in the inertial frame; what is left out stays as it is when the leg starts."""

    position: Three | None = Field(default=None, description="tool origin in the inertial frame [m]")
    move_by: Three | None = Field(default=None, description="the same as a displacement, inertial axes [m]")
    attitude_deg: Three | None = Field(default=None, description="roll, pitch, yaw of the tool, R = Rz Ry Rx [deg]")
    quaternion: Four | None = Field(default=None, description="the same as x, y, z, w, of any length but zero [-]")
    orientation: Literal["held", "free"] = Field(
        default="held", description="free: only the position is prescribed, for arms of fewer than six joints"
    )

    @model_validator(mode="after")
    def _said_once(self) -> Self:
        if self.position is not None and self.move_by is not None:
            raise ValueError("give position or move_by, not both")
        turned = [way for way in ("attitude_deg", "quaternion") if getattr(self, way) is not None]
        if len(turned) > 1 or (turned and self.orientation == "free"):
            raise ValueError("give attitude_deg, quaternion, or orientation: free")
        return self


class EndEffectorPoint(Waypoint):
    """A target of the base and of the joints or the tool, and when to be there."""

    tool: ToolTarget | None = Field(default=None, description="where the tool goes; the joints then follow")
    tools: dict[str, ToolTarget] = Field(
        default_factory=dict,
        description="the same of several arms: name of a tool -> where it goes; arms that are not named rest",
    )

    @model_validator(mode="after")
    def _joints_follow(self) -> Self:
        if self.tool is not None and self.tools:
            raise ValueError("give tool or tools, not both")
        follows = self.tool is not None or self.tools
        if follows and (self.joints, self.joints_deg, self.joints_by_deg) != (None, None, None):
            raise ValueError(f"give {'tools' if self.tools else 'tool'} or joints, not both")
        return self

    @model_serializer(mode="wrap")
    def _without_what_is_not(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        # A point of a single tool is, to the byte, what it was before there were several.
        return {key: value for key, value in handler(self).items() if key != "tools" or value}


class EndEffectorSpec(Strict):
    """The tool on straight lines and geodesics from rest to rest, quintic in time; it starts at time 0."""

    kind: Literal["end_effector"] = "end_effector"
    points: tuple[EndEffectorPoint, ...] = Field(min_length=1)
    smallest_singular_value: PositiveFloat = Field(
        default=0.02, description="of the tool Jacobian; closer to a singularity the motion is refused [m/rad, rad/rad]"
    )


class RecordedSpec(Strict):
    """References written down one by one; valid at exactly these stamps, and at rest at the last one afterwards."""

    kind: Literal["recorded"] = "recorded"
    stamps: tuple[NonNegativeInt, ...] = Field(min_length=1, description="increasing [ns]")
    q: Rows = Field(description="(7+n) each: position, quaternion, joints [m, -, rad]")
    v: Rows = Field(description="(6+n) each, base twist in the desired body frame [m/s, rad/s]")
    a: Rows = Field(description="(6+n) each, derivative of the components of v [m/s2, rad/s2]")


class LiveSpec(Strict):
    """Stay at the initial configuration until set-points come from outside during the run, on topics or an action."""

    kind: Literal["live"] = "live"
    base_speed: PositiveFloat = Field(
        default=0.05, description="of the base on the way to a `base/goal`, at most [m/s]"
    )
    base_rate_deg: PositiveFloat = Field(default=1.0, description="the same for its attitude [deg/s]")
    tool_speed: PositiveFloat = Field(
        default=0.05, description="of the tool on the way to a `tool/goal`, and under `teleop`, at most [m/s]"
    )
    tool_rate_deg: PositiveFloat = Field(default=2.0, description="the same for its attitude [deg/s]")
    teleop_timeout: PositiveFloat = Field(
        default=0.5, description="of the run without a message on `teleop`, after which the tool stops [s]"
    )
    teleop_ramp: PositiveFloat = Field(default=1.0, description="from rest to full speed, and back, under `teleop` [s]")
    smallest_singular_value: PositiveFloat = Field(
        default=0.02, description="of the tool Jacobian; closer to a singularity the tool does not go [m/rad, rad/rad]"
    )


ReferenceSpec = Annotated[
    HoldSpec | StepSpec | QuinticSpec | HarmonicSpec | WaypointsSpec | EndEffectorSpec | RecordedSpec | LiveSpec,
    Field(discriminator="kind"),
]
