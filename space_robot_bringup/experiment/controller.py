"""What an experiment says about its controller: a law, and the laws that may take over from it."""

from __future__ import annotations

from typing import Any

from pydantic import Field, NonNegativeFloat, PositiveFloat

from space_robot_bringup.experiment.timebase import steps_of
from space_robot_description.spec import Strict
from space_robot_description.validation import nearest
from space_robot_msgs_py.errors import SpecError


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
