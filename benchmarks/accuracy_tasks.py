"""What every engine is asked to do: a robot that swings freely under held efforts, and where it truly ends."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin
from scipy.integrate import solve_ivp

from space_robot_description.load import load_robot
from space_robot_msgs_py.interfaces import Command, Vector
from space_robot_sim.plant import InitialState, SimulatedRobot
from tests.support.robots import LivelyMotion, mjcf, robot_of

PERIOD, PERIODS = 100_000_000, 50
SATELLITE = {"mass": 300.0, "inertia": [75.0, 72.0, 78.0], "mount": {"xyz": [0.3, 0.0, 0.6]}}
# Ours, then two that others made: an arm, and a tree of four legs.
ROBOTS: dict[str, str | dict[str, Any]] = {
    "mini": "mini",
    "servicer": "servicer",
    "ets7": "ets7",
    "UR5": "ur5_sat",
    "ANYmal": {
        "name": "anymal",
        "urdf": "example-robot-data:anymal_b_simple_description/robots/anymal.urdf",
        "base": SATELLITE,
        "base_mode": "free_floating",
        "actuators": {"joints": {"effort": 80.0}, "base_torque": {"kind": "ideal", "limit": [1.0, 1.0, 1.0]}},
    },
}


@dataclass(frozen=True, eq=False, slots=True)
class Task:
    """One robot and its motion.

    Attributes:
        name: of the robot.
        model: of the whole robot, free base.
        q: (7+n,) where it starts.
        v: (6+n,) how fast, base twist in the body frame.
        efforts: (PERIODS, n) [N m].
    """

    name: str
    model: Any
    q: Vector
    v: Vector
    efforts: Vector

    @property
    def message(self) -> dict[str, Any]:
        """The task for an engine in a process of its own."""
        names = list(self.model.names[1:])
        numbers = {"q": self.q.tolist(), "v": self.v.tolist(), "efforts": self.efforts.tolist()}
        return {"xml": mjcf(self.model, 0.005), "bodies": names, "joints": names[1:], **numbers}


def task(name: str, periods: int = PERIODS) -> Task:
    """Joints swing by 0.6 to 1 rad at 0.05 to 0.1 Hz, the base drifts and turns; the efforts are a feedback law's."""
    model = load_robot(ROBOTS[name]).model
    motion = LivelyMotion(model, np.random.default_rng(6), speed=0.5)
    q, v = motion.start()
    plant = SimulatedRobot(robot_of(model, floating=True), control_period=PERIOD, initial=InitialState(q, v))
    sample, efforts = plant.reset(), []
    for k in range(periods):
        efforts.append(motion.effort(0.1 * k, sample.state.q, sample.state.v))
        sample = plant.step(Command(k * PERIOD, np.zeros(6), efforts[-1]))
    return Task(name, model, q, v, np.array(efforts))


def truth(task: Task, rtol: float = 1e-13) -> tuple[Vector, Vector]:
    """Configuration and velocity at the end, by scipy's DOP853 over Pinocchio's forward dynamics: none of our code.

    Args:
        task: what is done.
        rtol: of a step; the absolute tolerance is a tenth of it.
    """
    model, data, nq = task.model, task.model.createData(), task.q.size

    def slope(_: float, y: Vector, effort: Vector) -> Vector:
        q, v = y[:nq], y[nq:]
        x, y_, z, w = q[3:7]
        attitude = pin.Quaternion(w, x, y_, z)
        attitude.normalize()
        turn = pin.Quaternion(0.0, *(0.5 * v[3:6]))
        pose = np.concatenate([attitude.matrix() @ v[:3], (pin.Quaternion(w, x, y_, z) * turn).coeffs()])
        unit = np.concatenate([q[:3], attitude.coeffs(), q[7:]])
        return np.concatenate([pose, v[6:], pin.aba(model, data, unit, v, np.concatenate([np.zeros(6), effort]))])

    y = np.concatenate([task.q, task.v])
    for effort in task.efforts:
        y = solve_ivp(slope, (0.0, 0.1), y, "DOP853", args=(effort,), rtol=rtol, atol=0.1 * rtol).y[:, -1]
        y[3:7] /= np.linalg.norm(y[3:7])
    return y[:nq], y[nq:]


def error(q: Vector, q_true: Vector) -> float:
    """The largest difference of two configurations [m, rad or, of quaternions, half of it]."""
    q = np.concatenate([q[:3], q[3:7] * np.sign(q[3:7] @ q_true[3:7]), q[7:]])
    return float(np.max(np.abs(q - q_true)))


def drift(task: Task, q: Vector, v: Vector) -> float:
    """The share of its momentum about the origin that a robot has lost since the start, linear or angular."""
    first, last = _momentum(task, task.q, task.v), _momentum(task, q, v)
    parts = slice(0, 3), slice(3, 6)
    return max(float(np.linalg.norm(last[part] - first[part]) / np.linalg.norm(first[part])) for part in parts)


def _momentum(task: Task, q: Vector, v: Vector) -> Vector:
    """(6,) linear momentum, and angular about the origin [N s, N m s]; no force acts from outside."""
    data = task.model.createData()
    found = pin.computeCentroidalMomentum(task.model, data, np.array(q), np.array(v))
    linear, centre = found.linear.copy(), pin.centerOfMass(task.model, data, np.array(q)).copy()
    return np.concatenate([linear, found.angular + np.cross(centre, linear)])
