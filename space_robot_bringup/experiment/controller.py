"""What an experiment says about its controller: a law, and the laws that may take over from it."""

from __future__ import annotations

from typing import Any

from pydantic import Field, NonNegativeFloat, PositiveFloat

from space_robot_bringup.experiment.base import DEFAULT_LAW
from space_robot_bringup.experiment.timebase import steps_of
from space_robot_description.spec import Strict
from space_robot_description.validation import nearest
from space_robot_msgs_py.errors import SpecError

# In place of the name of a law: a node of another project commands, and no controller is made here.
EXTERNAL = "external"


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

    law: str = Field(
        default=DEFAULT_LAW, description="name of a law, module:Class, or external: a custom node commands"
    )
    gains: dict[str, Any] = Field(default_factory=dict, description="the law's own gains, checked by the law")
    standby: dict[str, StandbySpec] = Field(default_factory=dict, description="name -> law that may take over")
    switches: tuple[SwitchSpec, ...] = Field(default=(), description="when another law takes over, in order of time")
    handover: NonNegativeFloat = Field(
        default=5.0, description="how long the last command of the law before fades out after a switch [s]"
    )

    @property
    def external(self) -> bool:
        """A node of another project commands."""
        return self.law == EXTERNAL

    @property
    def law_names(self) -> tuple[str, ...]:
        """What every law is called where laws come from."""
        return () if self.external else tuple(one.law for one in self.laws.values())

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
        SpecError: a name twice or not there, times that are no ticks or not in order, or anything of a law where there
            is none.
    """
    if spec.external and (spec.gains or spec.standby or spec.switches):
        value = next(name for name in ("gains", "standby", "switches") if getattr(spec, name))
        raise SpecError("an external controller has none", key=f"controller.{value}", accepted="controller.law alone")
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


def check_made_here(spec: ControllerSpec) -> None:
    """Refuse to make the controller of a run that a node of another project commands.

    Raises:
        SpecError: it is such a run.
    """
    if spec.external:
        accepted = "the name of a law; or, with a node of your own, ros2 launch ... controller:=external"
        raise SpecError("has no controller here", key="controller.law", value=spec.law, accepted=accepted)
