"""The controller of an experiment: its law, or several behind one that switches between them."""

from __future__ import annotations

from collections.abc import Iterator

from space_robot_bringup.experiment.controller import ControllerSpec, check_made_here
from space_robot_bringup.experiment.timebase import to_nanoseconds
from space_robot_control.laws.base import Law
from space_robot_control.laws.policy import TYPED, LawPolicy
from space_robot_control.laws.registry import gains_of, law_class, make_law
from space_robot_control.laws.source import source_of
from space_robot_control.laws.switching import Switching
from space_robot_description.robot import Robot
from space_robot_msgs_py.errors import SpaceRobotError
from space_robot_msgs_py.log.header import LawSource


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
    check_made_here(spec)
    laws = {
        name: make_law(policy.law(name, one.law), robot, control_period, one.gains, _key(name, i), policy)
        for i, (name, one) in enumerate(spec.laws.items())
    }
    if not spec.standby:
        return laws[spec.law]
    switches = [(to_nanoseconds(switch.time, "controller.switches"), switch.to) for switch in spec.switches]
    return Switching(robot, control_period, laws, switches=switches, handover=spec.handover)


def gains_problems(spec: ControllerSpec, policy: LawPolicy = TYPED) -> Iterator[SpaceRobotError]:
    """What is wrong with names and gains of the laws; robot and control period are not looked at."""
    for i, (name, one) in enumerate(() if spec.external else spec.laws.items()):
        key = _key(name, i)
        try:
            gains_of(law_class(policy.law(name, one.law), f"{key}.law", policy), one.gains, key)
        except SpaceRobotError as error:
            yield error


def law_sources(spec: ControllerSpec, policy: LawPolicy = TYPED) -> dict[str, LawSource]:
    """Name in the experiment to the source of every custom law; see ``make_controller``."""
    if spec.external:
        return {}
    classes = {
        name: law_class(policy.law(name, one.law), f"{_key(name, i)}.law", policy)
        for i, (name, one) in enumerate(spec.laws.items())
    }
    sources = {name: source_of(cls) for name, cls in classes.items()}
    return {name: source for name, source in sources.items() if source is not None}


def _key(name: str, index: int) -> str:
    return f"controller.standby.{name}" if index else "controller"
