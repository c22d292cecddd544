"""From the plant section of an experiment to a plant: one maker and one check per kind."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from space_robot_bringup.plant_spec import AirbearingPlant, CapturedPlant, PlantSpec
from space_robot_description.robot import Robot
from space_robot_description.spec import expand
from space_robot_msgs_py.interfaces import NANOSECONDS, Plant
from space_robot_sim.grasp.airbearing import AirbearingTestbed
from space_robot_sim.grasp.captured import CapturedDebris, capability
from space_robot_sim.grasp.held import grasp_joints, whole_steps
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
    timing: Any = {"delay_periods": spec.delay_periods, "hold": spec.hold}
    return AirbearingTestbed(truth, spec, control_period=period, initial=initial, seed=seed, **timing)


def _pccs(spec: CapturedPlant, truth: Robot, period: int, initial: InitialState, seed: int) -> Plant:
    timing: Any = {"delay_periods": spec.delay_periods, "hold": spec.hold}
    return CapturedDebris(truth, spec, control_period=period, initial=initial, seed=seed, **timing)


def _check_airbearing(spec: AirbearingPlant, truth: Robot, period: int) -> None:
    grasp_joints(truth, spec.grasp)
    whole_steps(period, spec.step, "control_period")
    whole_steps(round(spec.camera.delay * NANOSECONDS), spec.step, "plant.camera.delay")


def _check_pccs(spec: CapturedPlant, truth: Robot, period: int) -> None:
    grasp_joints(truth, spec.grasp)
    capability(truth, spec)
    whole_steps(period, spec.step, "control_period")
    Sensors(spec.sensors, truth.n, period, seed=0)


PLANTS = {
    "articulated": PlantKind(_articulated, _check_articulated),
    "airbearing": PlantKind(_airbearing, _check_airbearing),
    "pccs": PlantKind(_pccs, _check_pccs),
}
