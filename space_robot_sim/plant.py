"""The true robot behind the Plant protocol: command in, measured state and telemetry with the truth out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal, NamedTuple

import numpy as np
import numpy.typing as npt

from space_robot_description.actuation import brake_torque, command_limit
from space_robot_description.kernel.arrays import RobotArrays, locked_joints
from space_robot_description.kernel.context import Context, context_of
from space_robot_description.kernel.jit import bound
from space_robot_description.known_arrays import arrays_of
from space_robot_description.robot import Robot
from space_robot_msgs_py.errors import IntegrationError, SpecError
from space_robot_msgs_py.interfaces import NANOSECONDS, Command, PlantSample, RobotState, Vector
from space_robot_msgs_py.kernel.products import times
from space_robot_sim.actuators import capability, initial_wheels, motor_numbers
from space_robot_sim.brakes import JointBrakes, stop
from space_robot_sim.capture import FreeBody, RobotChange, catch
from space_robot_sim.command_hold import Acting, CommandHold
from space_robot_sim.command_monitor import CommandMonitor
from space_robot_sim.faults.actuation import ActuationStage
from space_robot_sim.faults.joints import JointFriction
from space_robot_sim.faults.plan import FaultPlan
from space_robot_sim.faults.sensing import SensorStage
from space_robot_sim.faults.wires import CommandWire
from space_robot_sim.flexible.composed import check_composed
from space_robot_sim.flexible.parts import FlexibleParts
from space_robot_sim.flexible.spec import FlexibilitySpec
from space_robot_sim.initial import InitialState as InitialState
from space_robot_sim.integrators import compiled, stepping
from space_robot_sim.kernel.allocation import allocate
from space_robot_sim.kernel.disturbance import NOTHING
from space_robot_sim.kernel.momentum import ENERGY, LINEAR
from space_robot_sim.kernel.period import PlantContext, PlantMemory, advance, keep, plant_memory, reset_baseline, settle
from space_robot_sim.kernel.rhs import Drive
from space_robot_sim.kernel.steps import DONE, TOO_MANY_STEPS
from space_robot_sim.pinocchio_integrator import PinocchioIntegrator
from space_robot_sim.sensor_rule import check_wheels
from space_robot_sim.sensors import Sensors
from space_robot_sim.spec import DisturbanceSpec, Hold, IntegratorSpec, MonitorSpec, SensorSpec
from space_robot_sim.telemetry import PlantTelemetry
from space_robot_sim.unloading import Unloading


class PlantNumbers(NamedTuple):
    """A plant in numbers, see ``kernel/period.py`` and ``kernel/sensors.py``.

    Attributes:
        context: where ``advance`` finds all of it.
        memory: its state, which changes.
        sensors: what is seen of it.
        telemetry: its layout, and what it depends on.
        delay: periods by which a command acts late.
        reach: (2, 6+n) what of a command acts unchanged, see ``CommandMonitor``.
    """

    context: Context
    memory: PlantMemory
    sensors: Sensors
    telemetry: PlantTelemetry
    delay: int
    reach: Vector


class SimulatedRobot:
    """The true robot with its actuators and sensors.

    Args:
        robot: the truth.
        control_period: [ns].
        initial: where a run starts.
        integrator: how it is integrated.
        sensors: what is seen of it.
        seed: of the sensors' noise.
        delay_periods: 1: the command that answers state k acts from state k+1 on, and nothing does before.
        hold: what acts in place of a missing command: nothing, the last one, or the last one for some periods.
        changes: the robots that run in the course of a run, in order.
        faults: what goes wrong with its actuators and sensors, and the events that say so.
        monitor: what is checked of commands before they act; None: nothing.
        braked: the brakes of its joints may close, see ``close_brakes``; what they do is in the telemetry.
        unloads: likewise thrusters and wheels, see ``unload_wheels``.
        disturbance: what pushes the base beside its actuators, at all times.
        flexibility: what bends, twists and sloshes; None: all is rigid.

    Raises:
        SpecError: an argument does not fit the robot or the period.
    """

    def __init__(
        self,
        robot: Robot,
        *,
        control_period: int,
        initial: InitialState,
        integrator: IntegratorSpec | None = None,
        sensors: SensorSpec | None = None,
        seed: int = 0,
        delay_periods: Literal[0, 1] = 0,
        hold: Hold = "zero",
        changes: Sequence[RobotChange] = (),
        faults: FaultPlan | None = None,
        monitor: MonitorSpec | None = None,
        braked: bool = False,
        unloads: bool = False,
        disturbance: DisturbanceSpec | None = None,
        flexibility: FlexibilitySpec | None = None,
    ) -> None:
        if initial.q.size != 7 + robot.n:
            raise SpecError("wrong size", key="initial.q", value=initial.q.size, accepted=f"{7 + robot.n} numbers")
        if control_period <= 0:
            raise SpecError("not positive", key="control_period", value=control_period, accepted="nanoseconds > 0")
        spec = integrator or IntegratorSpec()
        self._initial = initial
        self._hold = CommandHold(robot.n, delay_periods=delay_periods, hold=hold)
        self._monitor = CommandMonitor(monitor, command_limit(robot), robot.joint_names)
        self._flexible = FlexibleParts(flexibility, robot)
        check_composed(self._flexible, robot, braked=braked, plan=faults)
        self._visible = robot.n
        # Joints that no motor drives stand behind the others, and are joints to all that integrates.
        self._n, hidden = robot.n + self._flexible.hidden, self._flexible.hidden
        self._period, self._seconds = control_period, control_period / NANOSECONDS
        self._changes = (RobotChange(0, robot), *changes)
        self._models = [self._flexible.model(one.robot) for one in self._changes]
        motors = [motor_numbers(one.robot, hidden) for one in self._changes]
        self._robots = list(map(arrays_of, self._models, motors))
        self._healthy = self._arrays = self._robots[0]
        self._able = capability(robot, control_period)
        self._plan = faults or FaultPlan((), control_period, 0)
        self._brake_torque = np.concatenate([brake_torque(robot), np.zeros(hidden)])
        self._brakes = JointBrakes(self._seconds) if braked else None
        self._unloading = Unloading(robot, self._seconds) if unloads else None
        names = (*robot.joint_names, *self._flexible.names)
        self._actuation = ActuationStage(self._plan, names, self._able, self._brake_torque, self._seconds)
        self._wire = CommandWire(self._plan)
        sensors = sensors or SensorSpec()
        check_wheels(sensors, robot)
        self._reads_wheels = sensors.wheel_momentum is not None
        self._sensing = SensorStage(self._plan, sensors)
        rough, fastest = bool(self._plan.of(JointFriction)), self._flexible.fastest
        self._how = stepping(spec, self._arrays, control_period, rough=rough, fastest=fastest)
        self._compiled = compiled(spec)
        self._wheels = initial_wheels(robot)
        self._sensors = Sensors(sensors, robot.n, control_period, seed)
        blocks: dict[str, Any] = {"estimated": spec.kind != "rk4", "braked": braked, "unloads": unloads}
        self._telemetry = PlantTelemetry(robot, self._wheels.size, self._flexible, **blocks)
        push = NOTHING if disturbance is None else disturbance.numbers
        memory = plant_memory(self._n, self._wheels.size, len(robot.mimics), self._flexible.more)
        self._memory = memory._replace(disturbance=push, springs=self._flexible.springs)
        self._context: Context | None = None
        if self._compiled:
            address = self.context().address
            self._advance_kernel = bound(advance, address, np.zeros(6 + robot.n), self._seconds, True)
        self._allocate = allocate
        if self._compiled and braked:
            # Before the run: a paced one would stand still while its first brake closes.
            plant = self._memory
            given = np.zeros(6 + robot.n), self._seconds, plant.wheels, plant.allocation
            self._allocate = bound(allocate, self._able, *given)
        self.reset()

    def reset(self) -> PlantSample:
        """Return to the initial state and show it (stamp 0)."""
        plant = self._memory
        for array in (plant.motors, plant.effort, plant.largest, plant.scratch.error, self._how.next_step):
            array[:] = 0.0
        self._memory.y[:] = 0.0
        self._flexible.begin(self._initial, self._memory.y)
        self._memory.wheels[:] = self._wheels
        self._stamp = 0
        nothing = self._hold.reset()
        self._monitor.reset()
        self._sensors.reset()
        self._able = self._actuation.reset()
        self._wire.reset()
        self._sensing.reset()
        self._closed, self._braking = False, [0.0] * (self._visible if self._brakes is not None else 0)
        self._unload, self._unloaded = False, [0.0] * (4 if self._unloading is not None else 0)
        self._switch_models()
        return self._show(nothing)

    def close_brakes(self, closed: bool) -> None:
        """Close the brakes of all joints, or open them, from the next step on."""
        self._closed = closed

    def unload_wheels(self, on: bool) -> None:
        """Let thrusters unload the wheels, or not, from the next step on; without such thrusters nothing happens."""
        self._unload = on and self._unloading is not None

    def step(self, command: Command | None) -> PlantSample:
        """Advance one control period under the command (None: the hold) and show the state at its end.

        Raises:
            CommandError: the command is not for this many joints.
            IntegrationError: the state stopped being finite, or the tolerance cannot be kept.
        """
        if self._stamp:
            self._switch_models()
        if self._wire.faulty:
            command = self._wire.carry(self._stamp // self._period, command)
        acting = self._hold.take(self._monitor.check(command))
        u = acting.u
        # Brakes that were closed have to be opened, too, and thrusters that fired to be closed.
        if (
            self._plan.planned
            or self._closed
            or self._hold.brakes
            or any(self._braking)
            or self._unload
            or any(self._unloaded)
        ):
            u = self._with_faults(u)
        status = self._advance(u)
        self._stamp += self._period
        if status != DONE:
            raise self._failure(status)
        return self._show(acting)

    def numbers(self) -> PlantNumbers | None:
        """The plant as it is, for runs that call no Python between their ticks; None where that cannot be."""
        if not self._compiled or self._plan.planned or self._reads_wheels or self._flexible.more:
            return None
        seen, late = (self._sensors, self._telemetry), self._hold.delay
        return PlantNumbers(self.context(), self._memory, *seen, late, self._monitor.reach())

    def context(self) -> Context:
        """Where compiled code finds robot, actuators and state as they are now."""
        known = self._context
        # Faults replace the two; a look at their addresses is all that other runs pay for it.
        if known is None or known.values.robot is not self._arrays or known.values.able is not self._able:
            known = context_of(PlantContext(self._arrays, self._able, self._how, self._memory), keep)
            self._context = known
        return known

    def switch_models(self, tick: int) -> None:
        """Let the robot that runs on from a tick run on, as ``step`` does; only between ``numbers`` and ``numbers``."""
        self._stamp = tick * self._period
        self._switch_models()

    def _switch_models(self) -> None:
        """Let the robot of this instant run on; what it catches is balanced, anything else has a new baseline."""
        for change, model, arrays in zip(self._changes, self._models, self._robots, strict=True):
            if change.stamp != self._stamp:
                continue
            self._model = model
            self._healthy = arrays
            self._use(self._healthy)
            if change.caught is not None:
                self._catch(change.caught)
            if change.caught is None or not self._stamp:
                self._memory.y[13 + 2 * self._n : 20 + 2 * self._n] = 0.0
                self._advance(self._hold.held.u, start=True)

    def _catch(self, body: FreeBody) -> None:
        """Rates jump; momentum and energy that the body brings were there from the start of the balance on."""
        y, n, initial = self._memory.y, self._n, self._memory.initial
        impact = catch(self._model, y[: 7 + n], y[7 + n : 13 + 2 * n].copy(), body)
        y[7 + n : 13 + 2 * n] = impact.velocity
        y[13 + 2 * n] += impact.work
        initial[LINEAR : LINEAR + 6] += impact.momentum
        initial[ENERGY] += impact.energy

    def _use(self, arrays: RobotArrays) -> None:
        """Integrate this robot from here on."""
        self._arrays = arrays
        self._fallback = None if self._compiled else PinocchioIntegrator(self._model, arrays)

    def _with_faults(self, command: Vector) -> Vector:
        """What the faults of this tick leave of a command; they also change actuators, motors and brakes."""
        acts = self._actuation.at(self._stamp // self._period, command, self._memory.wheels, self._healthy)
        self._able, arrays = acts.able, acts.arrays
        if self._unloading is not None:
            self._able, self._unloaded = self._unloading.able(
                acts.able, acts.command, self._memory.wheels, self._unload
            )
        held = locked_joints(arrays)
        if arrays is not self._arrays and np.any(held > locked_joints(self._arrays)):
            self._stop_joints(held)
        if self._brakes is not None:
            arrays = self._brake(self._brakes, arrays, acts.command, acts.brakes)
        if arrays is not self._arrays:
            self._use(arrays)
        return acts.command

    def _brake(self, brakes: JointBrakes, arrays: RobotArrays, command: Vector, torque: Vector) -> RobotArrays:
        """The robot with its brakes as they are in the period that begins."""
        fitted = self._brake_torque > 0.0
        if not (self._closed or self._hold.brakes):
            self._braking = [0.0] * self._visible
            return arrays
        self._allocate(self._able, command, self._seconds, self._memory.wheels, self._memory.allocation)
        found = brakes.act(self._model, arrays, self._memory, torque)
        y, n = self._memory.y, self._n
        y[7 + n : 13 + 2 * n] = found.velocity
        y[13 + 2 * n] += found.work
        self._braking = np.where(fitted, np.where(found.held, 1.0, -1.0), 0.0)[: self._visible].tolist()
        return found.arrays

    def _stop_joints(self, held: npt.NDArray[np.bool_]) -> None:
        """Brakes take the speed out of joints; their work counts as that of everything applied."""
        y, n = self._memory.y, self._n
        y[7 + n : 13 + 2 * n], work = stop(self._model, y[: 7 + n], y[7 + n : 13 + 2 * n].copy(), held)
        y[13 + 2 * n] += work

    def _advance(self, acting: Vector, *, start: bool = False) -> int:
        """One period under a command, or with ``start`` only the balance of the initial state; returns a status."""
        plant = self._memory
        if self._fallback is None:
            return self._advance_kernel(self.context().address, acting, self._seconds, start)
        count = allocate(self._able, acting, self._seconds, plant.wheels, plant.allocation)
        held = plant.allocation.segments, plant.allocation.effort, plant.motors
        drive = Drive(*held, plant.disturbance, plant.springs)
        if start:
            reset_baseline(self._arrays, self._able, drive, plant)
            return DONE
        status = self._fallback.integrate(drive, count, self._how, plant.y, plant.scratch)
        if status == DONE:
            settle(self._arrays, self._able, self._seconds, plant)
        return status

    def _show(self, acting: Acting) -> PlantSample:
        plant, gauges = self._memory, self._memory.gauges
        q, v = self._flexible.measured(plant.y)
        wheels = times(self._able.axes, plant.wheels) if self._reads_wheels else None
        truth = RobotState(self._stamp, q, v, plant.effort[: self._visible], gauges[4:], wheels)
        state, telemetry = (
            self._sensors.measure(truth),
            self._telemetry.of(self._stamp, acting, plant, self._braking + self._unloaded),
        )
        found = self._monitor.events(self._stamp)
        if not self._plan.planned:
            return PlantSample(state, telemetry, events=found)
        tick = self._stamp // self._period
        return PlantSample(self._sensing.read(tick, state), telemetry, self._plan.events(tick), found)

    def _failure(self, status: int) -> IntegrationError:
        when = f"between {(self._stamp - self._period) / NANOSECONDS:g} s and {self._stamp / NANOSECONDS:g} s"
        if status == TOO_MANY_STEPS:
            return IntegrationError(
                f"the tolerance cannot be kept {when}",
                key="integrator",
                accepted="a larger tolerance, slower motors or smoother friction",
            )
        return IntegrationError(f"not finite {when}", key=f"state.{_first_not_finite(self._memory, self._n)}")


def _first_not_finite(plant: PlantMemory, n: int) -> str:
    parts = {
        "position": slice(0, 3),
        "attitude": slice(3, 7),
        "joint_position": slice(7, 7 + n),
        "linear_velocity": slice(7 + n, 10 + n),
        "angular_velocity": slice(10 + n, 13 + n),
        "joint_velocity": slice(13 + n, 13 + 2 * n),
    }
    # Of several the velocities are named: they go first, and drag the positions along.
    for name in reversed(parts):
        if not np.isfinite(plant.y[parts[name]]).all():
            return name
    return "acceleration"
