"""What an experiment will probably run into, beyond what its law says: a sentence each, before the run is lost."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import pinocchio as pin

from space_robot_bringup.compose.composition import Composition
from space_robot_bringup.experiment.plant import PlantSpec
from space_robot_control.laws.registry import BUILT_IN
from space_robot_description.actuation import torque_capacity
from space_robot_description.foresight import robot_warnings
from space_robot_description.mass_matrix import mass_matrix, reduced_mass_matrix
from space_robot_description.robot import Robot
from space_robot_description.spec import ReactionWheels, expand
from space_robot_msgs_py.interfaces import NANOSECONDS, Reference, Vector
from space_robot_sim.flexible.modes import mode_frequencies
from space_robot_sim.flexible.parts import FlexibleParts
from space_robot_sim.spec import ChannelSpec

# References that are looked at; a step or a corner between two of them is seen in the accelerations around it.
_SAMPLES = 200
_RLS_UPDATES = ("rls", "rls_filtered", "composite")
# Of a limit; below, the limit does not decide.
_FULL = 1.0 + 1e-9


def foreseen(composition: Composition) -> tuple[str, ...]:
    """What `space-robot check` warns of beside the law's own review.

    Args:
        composition: of the run; nothing of it is stepped.
    """
    of_robot = robot_warnings(composition.nominal)
    plant = composition.experiment.plant
    if not isinstance(plant, PlantSpec):
        # The testbeds' joints are a grasp: no motor moves them.
        return of_robot
    references = _references(composition)
    return (
        *of_robot,
        *_momentum(composition, references[-1]),
        *_efforts(composition.nominal, references),
        *_friction(composition),
        *_readings(composition, plant.sensors.wheel_momentum),
        *_fast(composition),
        *_flexible(composition, plant),
    )


def _references(composition: Composition) -> list[Reference]:
    experiment, source = composition.experiment, composition.reference()
    stride = max(1, experiment.steps // _SAMPLES)
    return [source.at(tick * experiment.period) for tick in range(0, experiment.steps + 1, stride)]


def _momentum(composition: Composition, last: Reference) -> Iterator[str]:
    """Where no thruster is, momentum of the start ends in the wheels once everything rests."""
    robot = composition.truth
    wheels = robot.actuators.base_torque
    if not isinstance(wheels, ReactionWheels):
        return
    axes = np.array(wheels.axes)
    axes = (axes / np.linalg.norm(axes, axis=1, keepdims=True)).T
    q, v = composition.initial
    stored = axes @ np.array(wheels.initial_momentum or np.zeros(axes.shape[1]))
    total = _angular_momentum(robot, q, v) + _attitude(q) @ stored
    needed = np.linalg.pinv(axes) @ (_attitude(last.q).T @ total)
    if np.max(np.abs(needed)) > wheels.momentum * _FULL:
        yield (
            f"the robot starts with {np.linalg.norm(total):.3g} N m s, of which a wheel has to take "
            f"{np.max(np.abs(needed)):.3g} N m s once it rests as desired; its limit is {wheels.momentum:g} N m s"
        )


def _efforts(robot: Robot, references: Sequence[Reference]) -> Iterator[str]:
    """The desired motion by inverse dynamics of the nominal robot, against what pushes it."""
    torque = torque_capacity(robot)[0]
    force = robot.actuators.base_force
    limits = np.concatenate(
        [np.full(3, np.inf) if force is None else np.array(force.limit), torque, robot.effort_limit]
    )
    data = robot.model.createData()
    needed = np.array([_inverse_dynamics(robot, data, reference) for reference in references])
    share = np.abs(needed) / limits
    names = [f"base {kind} {axis}" for kind in ("force", "torque") for axis in "xyz"]
    names += [f"joint {name}" for name in robot.joint_names]
    for index in np.flatnonzero(np.max(share, axis=0) > _FULL).tolist():
        worst = int(np.argmax(share[:, index]))
        time = references[worst].stamp / NANOSECONDS
        yield (
            f"{names[index]}: the reference needs {abs(needed[worst, index]):.3g} at {time:g} s, "
            f"the limit is {limits[index]:g}"
        )


def _inverse_dynamics(robot: Robot, data: Any, reference: Reference) -> Vector:
    """(6+n,) generalised force of the desired motion; a base without thrusters drifts as the arm makes it."""
    model: Any = robot.model
    q, v, a = (np.array(part) for part in (reference.q, reference.v, reference.a))
    needed: Vector = pin.rnea(model, data, q, v, a).copy()
    if robot.base_mode == "free_floating":
        full = mass_matrix(model, q)
        needed = needed - full[:, :3] @ np.linalg.solve(full[:3, :3], needed[:3])
        needed[:3] = 0.0
    return needed


def _friction(composition: Composition) -> Iterator[str]:
    """No shipped law has friction in its equation, and a law of the user may; mfac adapts more slowly than it acts."""
    motors = composition.truth.actuators.joints
    names = composition.truth.joint_names
    laws = [name for name in composition.experiment.controller.law_names if name in BUILT_IN]
    values = {key: float(np.max(expand(getattr(motors, key), names, key))) for key in ("viscous", "coulomb")}
    acting = [f"{key} up to {value:g}" for key, value in values.items() if value > 0.0]
    if acting and laws and not composition.nominal.knows_friction:
        known = f"which {', '.join(laws)} does not know: joints may lag or stop short; see nominal.friction"
        yield f"the joints have friction ({', '.join(acting)}), {known}"


def _readings(composition: Composition, channel: ChannelSpec | None) -> Iterator[str]:
    """Least squares take the torque of the wheels from two readings: their noise over the period is noise of a row."""
    experiment = composition.experiment
    read = channel if composition.nominal.knows_wheels else None
    noise = 0.0 if read is None else np.sqrt(2.0) * float(np.max(read.noise)) / experiment.control_period
    for name, spec in experiment.controller.laws.items():
        if spec.law != "adaptive" or noise == 0.0:
            continue
        # Here: other laws do without the models of its gains.
        from space_robot_control.laws.adaptive.gains import AdaptiveGains

        gains = AdaptiveGains.model_validate(spec.gains)
        rls = gains.rls
        if gains.update in _RLS_UPDATES and rls.wheel_torque == "measured" and noise > 2.0 * rls.torque_noise:
            yield (
                f"the readings of the wheels give {name} torques with a noise of {noise:.3g} N m, of which it takes "
                f"{rls.torque_noise:g} (rls.torque_noise): its estimate will follow the noise"
            )


def _fast(composition: Composition) -> Iterator[str]:
    """Modes of the plant between two commands: what is as fast as the period is not what a sampled law expects."""
    robot, period = composition.truth, composition.experiment.control_period
    motors = robot.actuators.joints
    viscous = expand(motors.viscous, robot.joint_names, "viscous")
    inverse = np.linalg.inv(reduced_mass_matrix(robot.model, robot.home))[3:, 3:]
    fastest = float(np.max(np.linalg.eigvals(inverse * viscous).real, initial=0.0))
    if fastest * period > 1.0:
        yield f"friction slows a joint down within {1.0 / fastest:.3g} s, and commands are {period:g} s apart"
    lag = float(np.max(expand(motors.lag, robot.joint_names, "lag")))
    if lag > period:
        yield f"motors lag by {lag:g} s, longer than the control period of {period:g} s, and no law knows it"


def _flexible(composition: Composition, plant: PlantSpec) -> Iterator[str]:
    """Modes of panels, fuel and gears that commands this far apart do not see as oscillations."""
    rates, period = FlexibleParts(plant.flexibility, composition.truth).rates, composition.experiment.control_period
    fastest = max(mode_frequencies(rates), default=0.0)
    if 2.0 * np.pi * fastest * period > 1.0:
        yield (
            f"the fastest mode of plant.flexibility has {fastest:.3g} Hz at home: it oscillates {fastest * period:.2g} "
            "times in a control period, and no law knows it"
        )


def _angular_momentum(robot: Robot, q: Vector, v: Vector) -> Vector:
    """(3,) of the whole robot about its centre of mass, inertial axes [N m s]."""
    model: Any = robot.model
    found: Vector = pin.computeCentroidalMomentum(model, model.createData(), np.array(q), np.array(v)).angular.copy()
    return found


def _attitude(q: Vector) -> Vector:
    x, y, z, w = q[3:7]
    matrix: Vector = pin.Quaternion(w, x, y, z).toRotationMatrix()
    return matrix
