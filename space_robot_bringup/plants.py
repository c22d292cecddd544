"""From the plant section of an experiment to a plant: one maker and one check per kind."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from space_robot_bringup.plant_spec import AirbearingPlant, PlantSpec
from space_robot_description.robot import Robot
from space_robot_description.spec import expand
from space_robot_msgs_py.interfaces import Plant
from space_robot_sim.grasp.plant import AirbearingTestbed, grasp_joints, substeps
from space_robot_sim.initial import InitialState
from space_robot_sim.sensors import Sensors
from space_robot_sim.spec import fixed_steps, method


@dataclass(frozen=True, slots=True)
class PlantKind:
    """How plants of a kind are made.

    Attributes:
        make: (spec, true robot, control period [ns], initial state, seed) to a new plant.
        check: (spec, true robot, control period [ns]): what ``make`` would refuse, without waiting for a compiler.
    """

    make: Callable[[Any, Robot, int, InitialState, int], Plant]
    check: Callable[[Any, Robot, int], None]


def _articulated(spec: PlantSpec, truth: Robot, period: int, initial: InitialState, seed: int) -> Plant:
    # Only here: whoever needs no plant need not wait for its compiler.
    from space_robot_sim.plant import SimulatedRobot

    return SimulatedRobot(
        truth,
        control_period=period,
        initial=initial,
        integrator=spec.integrator,
        sensors=spec.sensors,
        seed=seed,
        delay_periods=spec.delay_periods,
        hold=spec.hold,
    )


def _check_articulated(spec: PlantSpec, truth: Robot, period: int) -> None:
    motors = truth.actuators.joints
    roughness = [expand(part, truth.joint_names, "joints") for part in (motors.lag, motors.viscous, motors.coulomb)]
    kind = method(spec.integrator, rough=bool(np.any(roughness)))
    if kind != "dop853_adaptive":
        fixed_steps(spec.integrator, kind, period)
    Sensors(spec.sensors, truth.n, period, seed=0)


def _airbearing(spec: AirbearingPlant, truth: Robot, period: int, initial: InitialState, seed: int) -> Plant:
    return AirbearingTestbed(
        truth,
        spec,
        control_period=period,
        initial=initial,
        seed=seed,
        delay_periods=spec.delay_periods,
        hold=spec.hold,
    )


def _check_airbearing(spec: AirbearingPlant, truth: Robot, period: int) -> None:
    grasp_joints(truth, spec)
    substeps(spec, period)


PLANTS = {
    "articulated": PlantKind(_articulated, _check_articulated),
    "airbearing": PlantKind(_airbearing, _check_airbearing),
}
