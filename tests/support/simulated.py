"""A law over a plant of a dozen lines with fine steps: what the law promises of a continuous robot."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from space_robot_control.laws import Law
from space_robot_description import rotations as rot
from space_robot_description.robot import Robot
from space_robot_msgs_py.interfaces import NANOSECONDS, ReferenceSource, RobotState, Telemetry, Vector


def simulate(
    law: Law, reference: ReferenceSource, truth: Robot, q: Vector, period: float, steps: int, substeps: int = 4
) -> list[tuple[RobotState, Telemetry, Vector]]:
    """A plant of a dozen lines: held commands, Runge-Kutta steps on forward dynamics. Rows: state, telemetry, u."""
    model, data, n = truth.model, truth.model.createData(), truth.n
    v, h, rows = np.zeros(6 + n), period / substeps, []
    law.reset()
    for k in range(steps):
        stamp = round(k * period * NANOSECONDS)
        state = RobotState(stamp, q, v, np.zeros(n), np.zeros(3))
        output = law.update(state, reference.at(stamp))
        u = output.command.u
        rows.append((state, output.telemetry, u))
        for _ in range(substeps):
            a1 = pin.aba(model, data, q, v, u)
            v2 = v + h / 2 * a1
            a2 = pin.aba(model, data, pin.integrate(model, q, h / 2 * v), v2, u)
            v3 = v + h / 2 * a2
            a3 = pin.aba(model, data, pin.integrate(model, q, h / 2 * v2), v3, u)
            v4 = v + h * a3
            a4 = pin.aba(model, data, pin.integrate(model, q, h * v3), v4, u)
            q = pin.integrate(model, q, h / 6 * (v + 2 * v2 + 2 * v3 + v4))
            v = v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
    return rows


def start(rotation: tuple[float, ...] = (0.0, 0.0, 0.0)) -> Vector:
    """At the origin, turned, arm bent."""
    return np.concatenate([np.zeros(3), rot.exp(rotation), [0.3, -0.8, 0.6, 0.4]])


def errors(rows: list[tuple[RobotState, Telemetry, Vector]], label: str) -> Vector:
    """One telemetry block over time."""
    return np.array([telemetry[label] for _, telemetry, _ in rows])
