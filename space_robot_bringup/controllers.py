"""What an experiment says about its controller: a law, and the laws that may take over from it."""

from __future__ import annotations

from typing import Any

from pydantic import Field, NonNegativeFloat, PositiveFloat

from space_robot_bringup.timebase import steps_of, to_nanoseconds
from space_robot_control.laws.base import Law
from space_robot_control.laws.policy import TYPED, LawPolicy
from space_robot_control.laws.registry import law_class, make_law
from space_robot_control.laws.source import source_of
from space_robot_control.laws.switching import Switching
from space_robot_description.robot import Robot
from space_robot_description.spec import Strict
from space_robot_description.validation import nearest
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.log_header import LawSource


class StandbySpec(Strict):
    """A law that may take over, under a name of its own."""

    law: str = Field(default="", description="name of a law, or module:Class; default: the name it stands under")
    gains: dict[str, Any] = Field(default_factory=dict, description="the law's own gains, checked by the law")


class SwitchSpec(Strict):
    """When which law takes over."""

    time: PositiveFloat = Field(description="[s], a multiple of the control period")
    to: str = Field(description="name of the law or of one in standby")


class ControllerSpec(Strict):
    """The law and its gains; defaults live with the law."""

    law: str = Field(default="computed_torque", description="name of a law, or module:Class")
    gains: dict[str, Any] = Field(default_factory=dict, description="the law's own gains, checked by the law")
    standby: dict[str, StandbySpec] = Field(default_factory=dict, description="name -> law that may take over")
    switches: tuple[SwitchSpec, ...] = Field(default=(), description="when another law takes over, in order of time")
    handover: NonNegativeFloat = Field(
        default=5.0, description="how long the last command of the law before fades out after a switch [s]"
    )

    @property
    def law_names(self) -> tuple[str, ...]:
        """What every law is called where laws come from."""
        return tuple(one.law for one in self.laws.values())

    @property
    def laws_by_name(self) -> dict[str, str]:
        """What every law is called in the experiment, and where laws come from."""
        return {name: one.law for name, one in self.laws.items()}

    @property
    def laws(self) -> dict[str, StandbySpec]:
        """Every law by name, the one that starts first."""
        first = StandbySpec(law=self.law, gains=self.gains)
        return {self.law: first} | {
            name: spec.model_copy(update={"law": spec.law or name}) for name, spec in self.standby.items()
        }


def check_controller(spec: ControllerSpec, control_period: float) -> None:
    """Refuse switches that cannot be done.

    Raises:
        SpecError: a name twice or not there, or times that are no ticks or not in order.
    """
    if spec.law in spec.standby:
        raise SpecError("is the law that starts", key=f"controller.standby.{spec.law}", accepted="another name")
    last = 0
    for index, switch in enumerate(spec.switches):
        key, names = f"controller.switches.{index}", tuple(spec.laws)
        if switch.to not in names:
            accepted = nearest(switch.to, names) or ", ".join(names)
            raise SpecError("no such law in this experiment", key=f"{key}.to", value=switch.to, accepted=accepted)
        if steps_of(switch.time, control_period, f"{key}.time") <= last:
            raise SpecError("not after the switch before", key=f"{key}.time", value=switch.time)
        last = steps_of(switch.time, control_period, f"{key}.time")


def make_controller(spec: ControllerSpec, robot: Robot, control_period: float, policy: LawPolicy = TYPED) -> Law:
    """The law, or the laws behind one that switches between them.

    Args:
        spec: checked, see ``check_controller``.
        robot: the NOMINAL robot.
        control_period: [s].
        policy: whose code may be a law.

    Raises:
        SpecError: a law, a gain or the period cannot be used.
    """
    laws = {
        name: make_law(policy.law(name, one.law), robot, control_period, one.gains, _key(name, i), policy)
        for i, (name, one) in enumerate(spec.laws.items())
    }
    if not spec.standby:
        return laws[spec.law]
    switches = [(to_nanoseconds(switch.time, "controller.switches"), switch.to) for switch in spec.switches]
    return Switching(robot, control_period, laws, switches=switches, handover=spec.handover)


def law_sources(spec: ControllerSpec, policy: LawPolicy = TYPED) -> dict[str, LawSource]:
    """Name in the experiment to the source of every custom law; see ``make_controller``."""
    classes = {
        name: law_class(policy.law(name, one.law), f"{_key(name, i)}.law", policy)
        for i, (name, one) in enumerate(spec.laws.items())
    }
    sources = {name: source_of(cls) for name, cls in classes.items()}
    return {name: source for name, source in sources.items() if source is not None}


def _key(name: str, index: int) -> str:
    return f"controller.standby.{name}" if index else "controller"
