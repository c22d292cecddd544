"""Faults of the joints: brake, motor, friction, gear, limit switch."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field, NonNegativeFloat, PositiveFloat

from space_robot_description.actuation import brake_torque
from space_robot_msgs_py.errors import SpecError
from space_robot_sim.faults.base import Actuation, ActuationFault, FaultSite, check_among

Factor = Annotated[float, Field(ge=0.0, le=1.0)]
Direction = Literal[1, -1]
# Columns of `Actuation.motors`.
VISCOUS, COULOMB = 1, 2


class JointFault(ActuationFault):
    """What all of them have: a joint."""

    group: ClassVar[str] = "joints"
    joint: str = Field(description="name of the joint")

    @property
    def place(self) -> str:
        """The joint."""
        return self.joint

    def check(self, site: FaultSite, key: str) -> None:
        """Refuse a joint that is not there."""
        check_among(self.joint, site.robot.joint_names, "joint", f"{key}.joint")

    def index(self, now: Actuation) -> int:
        """Which joint it is."""
        return list(now.joint_names).index(self.joint)

    def channel(self, now: Actuation) -> int:
        """Which channel of a command it is."""
        return 6 + self.index(now)


class JointStuck(JointFault):
    """The brake closes at once and holds: the joint stands still, its motor gives nothing, momentum is kept."""

    kind: Literal["joint_stuck"] = "joint_stuck"

    def act(self, now: Actuation, memory: dict[str, float]) -> None:
        """Hold the joint; the plant takes its speed away at the first tick."""
        now.locked[self.index(now)] = 1.0
        now.scale(self.channel(now), 0.0)


class JointBrakeWeak(JointFault):
    """The brake gives this part of its torque; with 0 it does not close; one that does not open is `joint_stuck`."""

    kind: Literal["joint_brake_weak"] = "joint_brake_weak"
    factor: Factor = Field(default=0.0, description="of the torque of the brake [-]")

    def check(self, site: FaultSite, key: str) -> None:
        """Refuse a joint that is not there, or has no brake."""
        super().check(site, key)
        if not brake_torque(site.robot)[site.robot.joint_names.index(self.joint)]:
            accepted = "a joint with one, see actuators.joints.brake"
            raise SpecError("the joint has no brake", key=f"{key}.joint", value=self.joint, accepted=accepted)

    def act(self, now: Actuation, memory: dict[str, float]) -> None:
        """Brake less."""
        now.brakes[self.index(now)] *= self.factor


class JointEffectiveness(JointFault):
    """The motor gives this part of what is commanded, and of its limit."""

    kind: Literal["joint_effectiveness"] = "joint_effectiveness"
    factor: Factor = Field(description="of the commanded effort [-]")

    def act(self, now: Actuation, memory: dict[str, float]) -> None:
        """Give less."""
        now.scale(self.channel(now), self.factor)


class JointOffset(JointFault):
    """The motor gives this much more than commanded, within its limit."""

    kind: Literal["joint_offset"] = "joint_offset"
    torque: float = Field(description="beside the commanded effort [N m or N]")

    def act(self, now: Actuation, memory: dict[str, float]) -> None:
        """Give more."""
        now.command[self.channel(now)] += self.torque


class JointFriction(JointFault):
    """The friction of the joint jumps."""

    kind: Literal["joint_friction"] = "joint_friction"
    viscous: NonNegativeFloat = Field(default=0.0, description="added viscous friction [N m s/rad]")
    coulomb: NonNegativeFloat = Field(default=0.0, description="added Coulomb friction [N m]")

    def act(self, now: Actuation, memory: dict[str, float]) -> None:
        """Rub."""
        now.motors[self.index(now), VISCOUS] += self.viscous
        now.motors[self.index(now), COULOMB] += self.coulomb


class JointFree(JointFault):
    """The joint swings freely: neither motor nor friction."""

    kind: Literal["joint_free"] = "joint_free"

    def act(self, now: Actuation, memory: dict[str, float]) -> None:
        """Let go."""
        now.scale(self.channel(now), 0.0)
        now.motors[self.index(now), [VISCOUS, COULOMB]] = 0.0


class JointRunaway(JointFault):
    """The motor gives all it can in one direction, whatever is commanded."""

    kind: Literal["joint_runaway"] = "joint_runaway"
    direction: Direction = Field(default=1, description="1 or -1")

    def act(self, now: Actuation, memory: dict[str, float]) -> None:
        """Push."""
        now.command[self.channel(now)] = self.direction * now.limit[self.channel(now)]


class JointBacklash(JointFault):
    """Play in the gear: after a reversal of the effort none is passed on until the motor has crossed the play.

    The motor crosses it at a constant speed, a part of the control period counts as a part of the effort, and the
    link moves on meanwhile. It begins in the middle of its play.
    """

    kind: Literal["joint_backlash"] = "joint_backlash"
    play: PositiveFloat = Field(description="from flank to flank [rad or m]")
    speed: PositiveFloat = Field(default=1.0, description="of the motor without load [rad/s or m/s]")

    def act(self, now: Actuation, memory: dict[str, float]) -> None:
        """Cross the play before pushing."""
        channel = self.channel(now)
        effort, at, reach = now.command[channel], memory.get("at", 0.5 * self.play), self.speed * now.period
        if effort == 0.0:
            return
        left = self.play - at if effort > 0.0 else at
        crossed = min(left, reach)
        memory["at"] = at + crossed if effort > 0.0 else at - crossed
        if left > 0.0:
            now.scale(channel, max(0.0, 1.0 - left / reach))


class JointLimitSwitch(JointFault):
    """A limit switch says falsely that the joint is at its end: no effort in that direction."""

    kind: Literal["joint_limit_switch"] = "joint_limit_switch"
    direction: Direction = Field(default=1, description="of the end, 1 or -1")

    def act(self, now: Actuation, memory: dict[str, float]) -> None:
        """Cut the effort towards the end."""
        if now.command[self.channel(now)] * self.direction > 0.0:
            now.command[self.channel(now)] = 0.0
