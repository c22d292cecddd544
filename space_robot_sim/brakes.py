"""Joint brakes: at rest they hold with what is needed, up to their torque; beyond it they slip against the motion."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from space_robot_description.kernel.arrays import RobotArrays, locked_joints, with_locked_joints
from space_robot_description.kernel.linear import solve
from space_robot_description.mass_matrix import mass_matrix
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.elementary import exp, tanh
from space_robot_msgs_py.kernel.products import dot, times
from space_robot_sim.flexible.springs import DAMPING, STIFFNESS
from space_robot_sim.kernel.period import PlantMemory
from space_robot_sim.kernel.rhs import COULOMB, COULOMB_VELOCITY, LAG, STORED, VISCOUS
from space_robot_sim.pinocchio_integrator import wrench_of

Joints = npt.NDArray[np.bool_]


class Braked(NamedTuple):
    """What closed brakes do in one period.

    Attributes:
        arrays: the robot, with joints that are held and the friction of those that slip.
        held: (n,) joints whose brake holds.
        velocity: (6+n,) after the brakes that hold have stopped their joints.
        work: of these brakes [J].
    """

    arrays: RobotArrays
    held: Joints
    velocity: Vector
    work: float


class JointBrakes:
    """Decides at the beginning of a period which closed brakes hold, by Coulomb's law of friction.

    A brake holds where the mean torque that it needs in this period, to stop its joint and to keep it at rest under
    what acts, is within its own: |p / T + t| <= B, with p the impulse that stops the joint, t the torque that keeps it,
    and B the brake's torque. p acts at once: momentum is kept, its work is counted. Where more is needed the joint that
    lacks most slips for the whole period under the friction B sgn(v), whose work the motors' friction counts, and the
    others are looked at again.

    Args:
        period: T [s].
    """

    def __init__(self, period: float) -> None:
        self._period = period
        self._last: tuple[RobotArrays, bytes, RobotArrays] | None = None

    def act(self, model: Any, robot: RobotArrays, plant: PlantMemory, torque: Vector) -> Braked:
        """What the brakes do, all closed.

        Args:
            model: ``pin.Model`` of the robot.
            robot: the same robot; a joint that is locked in it stays so, whatever its brake.
            plant: the state, and what the actuators do in this period (``allocate``).
            torque: (n,) of the brakes [N m or N]; 0: none.
        """
        n = torque.size
        q, v = plant.y[: 7 + n], plant.y[7 + n : 13 + 2 * n].copy()
        mass, locked = mass_matrix(model, q), locked_joints(robot)
        held = locked | (torque > 0.0)
        while True:
            slipping = ~held & (torque > 0.0)
            motors = robot.motors.copy()
            motors[slipping, COULOMB] += torque[slipping]
            after, impulse = _stopped(mass, v, held)
            applied = _applied(plant, motors, after, self._period)
            needed = impulse / self._period + _keeping(model, mass, q, after, held, applied)
            lacks = np.where(held & ~locked, np.abs(needed) - torque, -np.inf)
            worst = int(np.argmax(lacks))
            if not lacks[worst] > 0.0:
                break
            held[worst] = False
        work = 0.5 * (dot(after, times(mass, after)) - dot(v, times(mass, v))) if after is not v else 0.0
        return Braked(self._arrays(robot, held, motors), held & (torque > 0.0), after, work)

    def _arrays(self, robot: RobotArrays, held: Joints, motors: Vector) -> RobotArrays:
        """The robot with its brakes; the same one as before where nothing changed."""
        key = held.tobytes() + motors.tobytes()
        if self._last is None or self._last[0] is not robot or self._last[1] != key:
            self._last = robot, key, with_locked_joints(robot, held)._replace(motors=motors)
        return self._last[2]


def stop(model: Any, q: Vector, v: Vector, held: npt.NDArray[Any]) -> tuple[Vector, float]:
    """Stop joints at once by an impulse of their brakes, which is internal: momentum is kept, energy is lost.

    Args:
        model: ``pin.Model`` of the robot.
        q: (7+n,) configuration.
        v: (6+n,) velocity.
        held: (n,) not zero where a brake holds.

    Returns:
        (6+n,) velocity after it, and the work of the brakes [J].
    """
    mass = mass_matrix(model, q)
    after, _ = _stopped(mass, v, held != 0)
    return after, 0.5 * (dot(after, times(mass, after)) - dot(v, times(mass, v)))


def _keeping(model: Any, mass: Vector, q: Vector, v: Vector, held: Joints, applied: Vector) -> Vector:
    """(n,) torque in each held joint that keeps it at rest; 0 in the others."""
    rows, free = 6 + np.flatnonzero(held), np.ones(v.size, dtype=bool)
    free[rows] = False
    bias = pin.nonLinearEffects(model, model.createData(), q, v)
    acceleration = solve(mass[np.ix_(free, free)], (applied - bias)[free])
    out = np.zeros(held.size)
    out[rows - 6] = times(mass[np.ix_(rows, free)], acceleration) + (bias - applied)[rows]
    return out


def _stopped(mass: Vector, v: Vector, held: Joints) -> tuple[Vector, Vector]:
    """Velocity (6+n,) after the held joints have been stopped, and the impulse (n,) in each that does it.

    M (v+ - v) = S^T p and S v+ = 0, where S picks the held joints: internal, so momentum is kept.
    """
    rows = 6 + np.flatnonzero(held)
    out = np.zeros(held.size)
    if not v[rows].any():
        return v, out
    picks = np.zeros((rows.size, v.size))
    picks[np.arange(rows.size), rows] = 1.0
    response = solve(mass, picks.T)
    impulse = -solve(times(picks, response), v[rows])
    after = v + times(response, impulse)
    after[rows] = 0.0
    out[rows - 6] = impulse
    return after, out


def _applied(plant: PlantMemory, motors: Vector, v: Vector, period: float) -> Vector:
    """(6+n,) mean acting over the period [N, N m]: base, wheels with their momentum, motors, friction and springs."""
    allocation, n = plant.allocation, motors.shape[0]
    out = np.concatenate([allocation.wrench, allocation.effort])
    out[3:6] -= np.cross(v[3:6], allocation.segments[0, STORED : STORED + 3])
    if plant.disturbance.size:
        out[:6] += wrench_of(plant.disturbance, plant.y[3:7].tolist())
    for joint in range(n):
        lag, rate = float(motors[joint, LAG]), float(v[6 + joint])
        if lag > 0.0:
            late = lag * (1.0 - exp(-period / lag)) / period
            out[6 + joint] += (plant.motors[joint] - out[6 + joint]) * late
        out[6 + joint] -= motors[joint, VISCOUS] * rate
        out[6 + joint] -= motors[joint, COULOMB] * tanh(float(rate / motors[joint, COULOMB_VELOCITY]))
    if plant.springs.size:
        out[6:] -= plant.springs[:, STIFFNESS] * plant.y[7 : 7 + n] + plant.springs[:, DAMPING] * v[6:]
    return out
