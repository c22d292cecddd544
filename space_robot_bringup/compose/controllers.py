"""The controller of an experiment: its law, or several behind one that switches between them."""

from __future__ import annotations

from space_robot_bringup.experiment.controller import ControllerSpec
from space_robot_bringup.experiment.timebase import to_nanoseconds
from space_robot_control.laws.base import Law
from space_robot_control.laws.registry import make_law
from space_robot_control.laws.switching import Switching
from space_robot_description.robot import Robot


def make_controller(spec: ControllerSpec, robot: Robot, control_period: float) -> Law:
    """The law, or the laws behind one that switches between them.

    Args:
        spec: checked, see ``check_controller``.
        robot: the NOMINAL robot.
        control_period: [s].

    Raises:
        SpecError: a law, a gain or the period cannot be used.
    """
    if not spec.standby:
        return make_law(spec.law, robot, control_period, spec.gains)
    laws = {
        name: make_law(one.law, robot, control_period, one.gains, f"controller{f'.standby.{name}' if i else ''}")
        for i, (name, one) in enumerate(spec.laws.items())
    }
    switches = [(to_nanoseconds(switch.time, "controller.switches"), switch.to) for switch in spec.switches]
    return Switching(robot, control_period, laws, switches=switches, handover=spec.handover)
