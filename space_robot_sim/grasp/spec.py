"""What an experiment may say about a grasp, its cameras and what disturbs it."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, NonNegativeFloat, PositiveFloat

from space_robot_description.spec import Strict
from space_robot_sim.spec import SensorSpec

Share = Annotated[float, Field(ge=0.0, le=1.0)]


class GraspSpec(Strict):
    """A compliant grasp that slips: spring and damper in the plane, elasto-plastic torsion about the third joint."""

    joints: Annotated[tuple[str, ...], Field(min_length=3, max_length=3)] = Field(
        default=("grasp_x", "grasp_y", "grasp_angle"),
        description="the robot's joints that are the grasp: two prismatic, then a revolute one; they have no motors",
    )
    stiffness: NonNegativeFloat = Field(default=50.0, description="of the two prismatic joints [N/m]")
    damping: NonNegativeFloat = Field(default=16.43, description="of the two prismatic joints [N s/m]")
    torsional_stiffness: PositiveFloat = Field(default=4.0, description="until it slips [N m/rad]")
    torsional_damping: NonNegativeFloat = Field(default=1.0, description="of the elastic part [N m s/rad]")
    slip_torque: PositiveFloat = Field(default=0.042, description="torque at which it slips [N m]")


class CameraSpec(Strict):
    """Cameras that measure poses: the base in the plane, and the grasp."""

    position_noise: NonNegativeFloat = Field(default=3e-4, description="standard deviation [m]")
    angle_noise_deg: NonNegativeFloat = Field(default=0.02, description="standard deviation [deg]")
    outlier_share: Share = Field(default=0.005, description="share of samples that are wrong [-]")
    outlier_length: NonNegativeFloat = Field(default=0.2, description="largest error of a wrong position [m]")
    outlier_angle_deg: NonNegativeFloat = Field(default=10.0, description="largest error of a wrong angle [deg]")
    dropout_share: Share = Field(default=0.0, description="share of samples that repeat the one before [-]")
    delay: NonNegativeFloat = Field(default=0.1, description="age of a sample, whole integration steps [s]")


class DisturbanceSpec(Strict):
    """A constant push from outside, its direction by the seed."""

    force: NonNegativeFloat = Field(default=2e-3, description="in the plane, on the base origin [N]")
    torque: NonNegativeFloat = Field(default=1e-3, description="about the vertical [N m]")


class FlywheelSpec(Strict):
    """The flywheel as it is, beyond the limits of the robot file."""

    lag: NonNegativeFloat = Field(default=0.2, description="first-order lag of the torque [s]")


class OrbitSpec(Strict):
    """A virtual point on a circular orbit; the state is relative to it, axes parallel to the inertial ones.

    At time zero the point is on the x axis and moves along y.
    """

    radius: PositiveFloat = Field(default=6.878e6, description="of the orbit [m]")
    mu: PositiveFloat = Field(default=3.986004418e14, description="gravitational parameter [m3/s2]")


class ConfigurationChange(Strict):
    """The grasp shifts: where it rests moves from one place to another during a run (Table 1 of the paper)."""

    start: NonNegativeFloat = Field(description="[s]")
    duration: PositiveFloat = Field(description="[s]")
    offset: float = Field(default=0.0, description="along the first joint of the grasp [m]")
    angle_deg: float = Field(default=0.0, description="about the third [deg]")


class CapturedSpec(Strict):
    """A robot in space that holds debris: what is not in the robot file."""

    grasp: GraspSpec = Field(default_factory=GraspSpec, description="how the debris is held")
    change: ConfigurationChange | None = Field(default=None, description="a shift of the grasp during the run")
    orbit: OrbitSpec | None = Field(default=None, description="central gravity; default: free space")
    sensors: SensorSpec = Field(default_factory=SensorSpec)
    step: PositiveFloat = Field(default=0.05, description="of the integration, divides the control period [s]")


class AirbearingSpec(Strict):
    """A testbed on air bearings: everything about it that is not in the robot file."""

    grasp: GraspSpec = Field(default_factory=GraspSpec, description="how the second body is held")
    camera: CameraSpec = Field(default_factory=CameraSpec, description="what is measured")
    disturbance: DisturbanceSpec = Field(default_factory=DisturbanceSpec, description="a push from outside")
    flywheel: FlywheelSpec = Field(default_factory=FlywheelSpec)
    thruster_offset: float = Field(default=0.02, description="y of the thrusters' line of action in the base [m]")
    step: PositiveFloat = Field(default=0.05, description="of the integration, divides control period and delay [s]")
