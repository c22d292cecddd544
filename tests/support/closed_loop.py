"""A law in a loop with a plant of a dozen lines, and states for it: what comparisons with references are made of."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin

from space_robot_control.laws import Law
from space_robot_description.mass_matrix import mass_matrix
from space_robot_description.mimic import has_followers
from space_robot_description.robot import Robot
from space_robot_msgs_py.interfaces import NANOSECONDS, ControlOutput, Reference, ReferenceSource, RobotState, Vector
from tests.support.robots import random_state


def random_pair(rng: np.random.Generator, n: int, stamp: int = 0, speed: float = 0.3) -> tuple[RobotState, Reference]:
    """A random state and a random moving reference of the same stamp."""
    (q, v), (q_d, v_d) = (random_state(rng, n, speed) for _ in range(2))
    state = RobotState(stamp, q, v, rng.normal(size=n), rng.normal(size=3))
    return state, Reference(stamp, q_d, v_d, speed * rng.normal(size=6 + n))


def closed_loop(
    law: Law, truth: Robot, reference: ReferenceSource, q: Vector, steps: int, substeps: int = 4
) -> list[tuple[RobotState, Reference, ControlOutput]]:
    """Every tick of a run of a law from rest at q (7+n,); commands are held over a period, efforts measured exactly."""
    model, data, period = truth.model, truth.model.createData(), law.control_period
    v, effort, ticks = np.zeros(6 + truth.n), np.zeros(truth.n), []
    law.reset()
    for k in range(steps):
        stamp = round(k * period * NANOSECONDS)
        state, desired = RobotState(stamp, q, v, effort, np.zeros(3)), reference.at(stamp)
        output = law.update(state, desired)
        ticks.append((state, desired, output))
        u = output.command.u
        for _ in range(substeps):
            v = v + period / substeps * _acceleration(model, data, q, v, u)
            q = pin.integrate(model, q, period / substeps * v)
        effort = u[6:]
    return ticks


def off(found: Any, expected: Any) -> float:
    """Largest difference over the largest number."""
    return float(np.abs(np.asarray(found) - expected).max() / np.abs(expected).max())


def _acceleration(model: Any, data: Any, q: Vector, v: Vector, u: Vector) -> Vector:
    """``pin.aba``, which has no place for joints that follow others."""
    if not has_followers(model):
        return np.array(pin.aba(model, data, q, v, u))
    return np.linalg.solve(mass_matrix(model, q), u - pin.nonLinearEffects(model, data, q, v))
