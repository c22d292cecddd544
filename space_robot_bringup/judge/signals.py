"""Numbers over time that an experiment may expect something of: the truth, by the names monitors have for it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from space_robot_bringup.judge.metrics import Matrix, deviations
from space_robot_description.robot import Robot
from space_robot_description.spec import ReactionWheels
from space_robot_msgs_py.errors import LayoutError
from space_robot_msgs_py.interfaces import Vector

XYZ = ("x", "y", "z")


@dataclass(frozen=True, eq=False, slots=True)
class Rows:
    """K successive ticks.

    Attributes:
        plant: telemetry of the plant by label, (K, size).
        q_d: (K, 7+n) desired configuration.
        v_d: (K, 6+n) desired velocity.
    """

    plant: Mapping[str, Matrix]
    q_d: Matrix
    v_d: Matrix

    @property
    def q(self) -> Matrix:
        """(K, 7+n) true configuration."""
        return self.block("true_configuration")

    @property
    def v(self) -> Matrix:
        """(K, 6+n) true velocity."""
        return self.block("true_velocity")

    @property
    def errors(self) -> Matrix:
        """(K, 6+n) see ``deviations``."""
        return deviations(self.q, self.q_d)

    def block(self, label: str) -> Matrix:
        """A block of the plant's telemetry.

        Raises:
            LayoutError: it is not there.
        """
        if label not in self.plant:
            raise LayoutError("no such block", key="telemetry", value=label, accepted=", ".join(self.plant))
        return self.plant[label]


@dataclass(frozen=True, eq=False, slots=True)
class Signal:
    """A number over time.

    Attributes:
        unit: of it.
        read: (K,) of K ticks.
    """

    unit: str
    read: Callable[[Rows], Vector]


def signals_of(robot: Robot) -> dict[str, Signal]:
    """Every signal of a robot by name."""
    joint_units = ["m" if prismatic else "rad" for prismatic in robot.prismatic]
    joint = joint_units[0] if len(set(joint_units)) == 1 else "rad or m"
    found = {
        "base.rate": Signal("rad/s", lambda rows: _length(rows.v[:, 3:6])),
        "base.speed": Signal("m/s", lambda rows: _length(rows.v[:, :3])),
        "joints.rate": Signal(f"{joint}/s", lambda rows: _largest(rows.v[:, 6:])),
        "error.position": Signal("m", lambda rows: _length(rows.errors[:, :3])),
        "error.attitude": Signal("rad", lambda rows: _length(rows.errors[:, 3:6])),
        "error.joints": Signal(joint, lambda rows: _largest(rows.errors[:, 6:])),
        "joints.beyond": Signal(joint, lambda rows: _largest(rows.block("joint_limit"))),
    }
    torque = robot.actuators.base_torque
    if isinstance(torque, ReactionWheels):
        full = torque.momentum
        found["wheels.load"] = Signal("of their capacity", lambda rows: _largest(rows.block("wheel_momentum")) / full)
    parts: Sequence[tuple[str, Sequence[str], Sequence[str], Callable[[Rows], Matrix]]] = (
        ("position", XYZ, ["m"] * 3, lambda rows: rows.q[:, :3]),
        ("rate", XYZ, ["rad/s"] * 3, lambda rows: rows.v[:, 3:6]),
        ("joint.position", robot.joint_names, joint_units, lambda rows: rows.q[:, 7:]),
        ("joint.rate", robot.joint_names, [f"{unit}/s" for unit in joint_units], lambda rows: rows.v[:, 6:]),
    )
    for part, names, units, read in parts:
        found |= {f"{part}.{name}": Signal(units[index], _column(read, index)) for index, name in enumerate(names)}
    return found


def _column(read: Callable[[Rows], Matrix], index: int) -> Callable[[Rows], Vector]:
    return lambda rows: read(rows)[:, index]


def _length(rows: Matrix) -> Vector:
    length: Vector = np.sqrt((rows * rows).sum(axis=1))
    return length


def _largest(rows: Matrix) -> Vector:
    largest: Vector = np.abs(rows).max(axis=1, initial=0.0)
    return largest
