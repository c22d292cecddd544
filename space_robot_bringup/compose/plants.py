"""From the plant section of an experiment to a plant: one maker and one check per kind."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from space_robot_bringup.experiment.experiment import Experiment
from space_robot_bringup.experiment.plant import AirbearingPlant, CapturedPlant, PlantSpec, PlantTiming
from space_robot_bringup.experiment.timebase import steps_of, to_nanoseconds
from space_robot_description.actuation import brake_torque
from space_robot_description.payload import attach_payload
from space_robot_description.robot import Robot
from space_robot_description.spec import expand
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import NANOSECONDS, Plant
from space_robot_sim.capture import RobotChange, free_body
from space_robot_sim.faults.plan import FaultPlan
from space_robot_sim.initial import InitialState, RunConditions
from space_robot_sim.sensor_rule import check_sensors
from space_robot_sim.spec import HoldFor, fixed_steps, method

Changes = tuple[RobotChange, ...]


@dataclass(frozen=True, eq=False, slots=True)
class PlantParts:
    """What a plant is made from besides its section of the experiment.

    Attributes:
        truth: the true robot, as it starts.
        period: control period [ns].
        initial: where it starts.
        seed: of everything random in the plant.
        changes: the true robots of the course of the run, in order.
        faults: what goes wrong; None: nothing.
        braked: a supervisor may close the brakes of the joints.
        unloads: a supervisor may have thrusters unload the wheels.
    """

    truth: Robot
    period: int
    initial: InitialState
    seed: int
    changes: Changes
    faults: FaultPlan | None = None
    braked: bool = False
    unloads: bool = False


@dataclass(frozen=True, slots=True)
class PlantKind:
    """How plants of a kind are made.

    Attributes:
        make: (spec, parts) to a new plant.
        check: (spec, true robot, control period [ns]): what ``make`` would refuse, without waiting for a compiler.
        changes: (spec, true robot, control period [s]): when the true robot changes.
    """

    make: Callable[[Any, PlantParts], Plant]
    check: Callable[[Any, Robot, int], None]
    changes: Callable[[Any, Robot, float], Changes]


def _articulated(spec: PlantSpec, parts: PlantParts) -> Plant:
    # Here as below: what needs no plant, or another one, does not wait for its compiler.
    from space_robot_sim.plant import SimulatedRobot

    return SimulatedRobot(
        parts.truth,
        control_period=parts.period,
        initial=parts.initial,
        integrator=spec.integrator,
        sensors=spec.sensors,
        seed=parts.seed,
        delay_periods=spec.delay_periods,
        hold=spec.hold,
        changes=parts.changes,
        faults=parts.faults,
        monitor=spec.monitor,
        braked=parts.braked or brakes_when_silent(spec),
        unloads=parts.unloads,
        disturbance=spec.disturbance,
    )


def brakes_when_silent(spec: PlantTiming) -> bool:
    """The brakes of the joints close where commands are missing."""
    return isinstance(spec.hold, HoldFor) and spec.hold.brakes


def check_brakes(experiment: Experiment, truth: Robot) -> None:
    """Refuse to close brakes that are not there.

    Raises:
        SpecError: the message names the key.
    """
    table = experiment.supervision
    modes = {} if table is None else table.modes
    wanted = [f"supervision.modes.{name}.brakes" for name, mode in modes.items() if mode.brakes]
    wanted += ["plant.hold.brakes"] if brakes_when_silent(experiment.plant) else []
    if not wanted:
        return
    if experiment.plant.kind != "articulated" or not brake_torque(truth).any():
        accepted = "an articulated robot with actuators.joints.brake"
        raise SpecError("the robot has no brakes", key=wanted[0], value=True, accepted=accepted)


def check_unloading(experiment: Experiment, truth: Robot) -> None:
    """Refuse to unload wheels without thrusters, or unseen: laws would reckon what the wheels hold without that.

    Raises:
        SpecError: the message names the key.
    """
    modes = {} if experiment.supervision is None else experiment.supervision.modes
    wanted = [f"supervision.modes.{name}.unload" for name, mode in modes.items() if mode.unload]
    if not wanted:
        return
    if experiment.plant.kind != "articulated" or getattr(truth.actuators.base_torque, "unloading", None) is None:
        accepted = "an articulated robot with actuators.base_torque.unloading"
        raise SpecError("no thrusters unload the wheels of this robot", key=wanted[0], value=True, accepted=accepted)
    if experiment.plant.sensors.wheel_momentum is None:
        raise SpecError("needs a reading of the wheels", key=wanted[0], accepted="plant.sensors.wheel_momentum")


def _captures(spec: PlantSpec, truth: Robot, control_period: float) -> Changes:
    if spec.capture is None:
        return ()
    period = to_nanoseconds(control_period, "control_period")
    laden = attach_payload(truth, spec.capture.payload)
    stamp = capture_tick(spec, control_period) * period
    return (RobotChange(stamp, laden, free_body(truth, spec.capture)),)


def capture_tick(spec: PlantSpec, control_period: float) -> int:
    """The tick from which a body is held that is caught in a run; -1: none is."""
    return -1 if spec.capture is None else steps_of(spec.capture.time, control_period, "plant.capture.time")


def _check_articulated(spec: PlantSpec, truth: Robot, period: int) -> None:
    motors = truth.actuators.joints
    roughness = [expand(part, truth.joint_names, "joints") for part in (motors.lag, motors.viscous, motors.coulomb)]
    kind = method(spec.integrator, rough=bool(np.any(roughness)))
    if kind != "dop853_adaptive":
        fixed_steps(spec.integrator, kind, period)
    check_sensors(spec.sensors, truth, period)


def _airbearing(spec: AirbearingPlant, parts: PlantParts) -> Plant:
    from space_robot_sim.grasp.airbearing import AirbearingTestbed

    return AirbearingTestbed(parts.truth, spec, _conditions(spec, parts))


def _pccs(spec: CapturedPlant, parts: PlantParts) -> Plant:
    from space_robot_sim.grasp.captured import CapturedDebris

    return CapturedDebris(parts.truth, spec, _conditions(spec, parts))


def _conditions(spec: PlantTiming, parts: PlantParts) -> RunConditions:
    return RunConditions(parts.period, parts.initial, parts.seed, spec.delay_periods, spec.hold, spec.monitor)


def _no_changes(spec: PlantTiming, truth: Robot, control_period: float) -> Changes:
    del spec, truth, control_period
    return ()


def _check_airbearing(spec: AirbearingPlant, truth: Robot, period: int) -> None:
    from space_robot_sim.grasp.plant import grasp_joints, whole_steps

    grasp_joints(truth, spec.grasp)
    whole_steps(period, spec.step, "control_period")
    whole_steps(round(spec.camera.delay * NANOSECONDS), spec.step, "plant.camera.delay")


def _check_pccs(spec: CapturedPlant, truth: Robot, period: int) -> None:
    from space_robot_sim.grasp.captured import capability
    from space_robot_sim.grasp.plant import grasp_joints, whole_steps

    grasp_joints(truth, spec.grasp)
    capability(truth, spec)
    whole_steps(period, spec.step, "control_period")
    check_sensors(spec.sensors, truth, period)


PLANTS = {
    "articulated": PlantKind(_articulated, _check_articulated, _captures),
    "airbearing": PlantKind(_airbearing, _check_airbearing, _no_changes),
    "pccs": PlantKind(_pccs, _check_pccs, _no_changes),
}
