"""What every fault has: a kind, a window of time, a name; and what it needs to know of the robot to be checked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar

from pydantic import Field, NonNegativeFloat, PositiveFloat, SerializerFunctionWrapHandler, model_serializer

from space_robot_description.robot import Robot
from space_robot_description.spec import ReactionWheels, Strict, Title
from space_robot_description.validation import nearest
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Vector
from space_robot_sim.spec import SensorSpec

# What the fields of every fault are called, in files and on the command line.
COMMON = ("kind", "at", "for", "name")
AXES = ("force_x", "force_y", "force_z", "torque_x", "torque_y", "torque_z")


@dataclass(frozen=True, eq=False, slots=True)
class FaultSite:
    """The robot that faults happen to.

    Attributes:
        robot: the truth, as it starts.
        sensors: what it measures with.
        period: control period [s].
        holds_payload: something is in its hand at the start or later.
    """

    robot: Robot
    sensors: SensorSpec = field(default_factory=SensorSpec)
    period: float = 0.1
    holds_payload: bool = False

    @property
    def wheels(self) -> int:
        """Number of reaction wheels."""
        torque = self.robot.actuators.base_torque
        return len(torque.axes) if isinstance(torque, ReactionWheels) else 0

    @property
    def axes(self) -> tuple[str, ...]:
        """Axes of the base that something pushes from outside."""
        actuators = self.robot.actuators
        torques = () if isinstance(actuators.base_torque, ReactionWheels) else AXES[3:]
        return (*(AXES[:3] if actuators.base_force is not None else ()), *torques)


class Fault(Strict):
    """One thing that goes wrong, from one tick to another."""

    # In the order of the catalogue; empty: a class that only others derive from.
    group: ClassVar[str] = ""

    kind: str
    at: NonNegativeFloat = Field(description="onset [s]: acts from the first tick at or after it")
    for_: PositiveFloat | None = Field(
        default=None,
        alias="for",
        description="how long [s]: to the first tick at or after; null: to the end of the run",
    )
    name: Title = Field(default="", description="what its events are called; default: made of kind and place")

    @model_serializer(mode="wrap")
    def _said_as_typed(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        # `for` is a word of Python: the field has another name, files do not.
        return {"for" if key == "for_" else key: value for key, value in handler(self).items()}

    @property
    def place(self) -> str:
        """What part of the robot it is about; empty: the robot."""
        return ""

    def check(self, site: FaultSite, key: str) -> None:
        """Refuse what this robot does not have.

        Args:
            site: the robot.
            key: of this fault, for errors.

        Raises:
            SpecError: the message names the key, the value and what is accepted.
        """


@dataclass(slots=True)
class Actuation:
    """What acts on the robot in one period; faults change it, the plant obeys it.

    Attributes:
        joint_names: (n) in model order.
        period: [s].
        command: (6+n,) generalised force that was commanded [N, N m].
        limit: (6+n,) largest magnitude per channel.
        motors: (n, 4) lag, viscous and Coulomb friction, Coulomb velocity of every joint.
        locked: (n,) joints that are stuck.
        brakes: (n,) torque of the joints' brakes where they are closed [N m or N].
        share: (k, 3) share of every wheel in a commanded torque.
        wheel_limit: (k, 2) torque and momentum of every wheel.
        wheels: (k,) momenta at the beginning of the period [N m s].
        push: (k,) torque on every wheel beside the commanded one [N m].
        outside: (6,) force and torque on the base from outside, body frame [N, N m].
    """

    joint_names: Sequence[str]
    period: float
    command: Vector
    limit: Vector
    motors: Vector
    locked: Vector
    brakes: Vector
    share: Vector
    wheel_limit: Vector
    wheels: Vector
    push: Vector
    outside: Vector

    def scale(self, channel: int, factor: float) -> None:
        """Let a channel give this part of what it would give."""
        self.command[channel] *= factor
        self.limit[channel] *= factor


class ActuationFault(Fault):
    """A fault between the command and what acts."""

    def act(self, now: Actuation, memory: dict[str, float]) -> None:
        """Change what acts in this period.

        Args:
            now: what acts; faults before this one have changed it already.
            memory: of this fault, empty at its onset.
        """
        raise NotImplementedError


def check_among(name: str, names: Sequence[str], what: str, key: str) -> None:
    """Refuse a name that is not among these.

    Raises:
        SpecError: with the nearest names.
    """
    if name not in names:
        accepted = nearest(name, names) or ", ".join(names) or f"a robot with {what}s"
        raise SpecError(f"no such {what}", key=key, value=name, accepted=accepted)


def said(fault: Fault) -> Mapping[str, Any]:
    """The keys of a fault that are its own, as plain data."""
    return {key: value for key, value in fault.model_dump(mode="json").items() if key not in COMMON}
