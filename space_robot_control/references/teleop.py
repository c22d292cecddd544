"""The tool moved by hand: a twist that is said again and again, and a stop when it is not."""

from __future__ import annotations

from math import hypot, radians

import numpy as np

from space_robot_control.references.spec import LiveSpec
from space_robot_control.references.targets import LIMIT_TOLERANCE
from space_robot_control.references.tool_kinematics import ToolKinematics
from space_robot_description.robot import Robot
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import NANOSECONDS, Vector

Motion = tuple[list[float], list[float], list[float]]


class Teleop:
    """Integrates the joint rates that move the tool as wanted, tick by tick, while the base keeps its attitude.

    The twist grows and falls within ``teleop_ramp``; it is zero ``teleop_timeout`` of the run after the last one that
    was heard. Between two ticks rates are linear in time. The arm stands still where it would leave a joint limit or
    come too near to a singularity.

    Args:
        spec: limits.
        robot: the NOMINAL robot.
        q: (7+n,) configuration to start from, at rest [m, -, rad].
        stamp: of that configuration [ns].
        period: control period [ns].

    Attributes:
        stopped_by: why the arm stands still although it is to move; empty: it does not.
    """

    def __init__(self, spec: LiveSpec, robot: Robot, q: Vector, stamp: int, period: int) -> None:
        self._robot, self._seconds = robot, period / NANOSECONDS
        self._kinematics = ToolKinematics(robot, q, spec.smallest_singular_value)
        self._limits = spec.tool_speed, radians(spec.tool_rate_deg)
        self._timeout, self._ramp = round(spec.teleop_timeout * NANOSECONDS), spec.teleop_ramp
        self._q, self._v, self._heard = np.array(q), np.zeros(q.size - 1), stamp
        self._wanted, self._twist = np.zeros(6), np.zeros(6)
        self.stopped_by = ""

    def say(self, twist: Vector, stamp: int) -> None:
        """Take a twist (6,) in the axes of the tool [m/s, rad/s], scaled down to the limits, from a stamp [ns] on."""
        self._wanted = np.concatenate([_shortened(twist[i : i + 3], self._limits[i // 3]) for i in (0, 3)])
        self._heard = stamp

    @property
    def resting(self) -> bool:
        """True when it has come to rest and no motion is wanted."""
        return not (self._wanted.any() or self._twist.any() or self._v.any())

    def step(self, stamp: int) -> Motion:
        """Return q (7+n,), v and a (6+n,) one period later, at the stamp [ns], linear parts in the inertial frame."""
        if stamp - self._heard > self._timeout:
            self._wanted = np.zeros(6)
        share = min(self._seconds / self._ramp, 1.0)
        change = self._wanted - self._twist
        for part, limit in zip((change[:3], change[3:]), self._limits, strict=True):
            part[:] = _shortened(part, share * limit)
        self._twist = self._twist + change
        v, q = self._moved()
        a = (v - self._v) / self._seconds
        self._q, self._v = q, v
        return q.tolist(), v.tolist(), a.tolist()

    def _moved(self) -> tuple[Vector, Vector]:
        self.stopped_by = ""
        try:
            rates, base = self._kinematics.rates(self._q, self._twist)
            excess = np.abs(rates) / self._robot.joint_rate_limit
            rates, base = rates / max(1.0, float(excess.max())), base / max(1.0, float(excess.max()))
        except SpecError as error:
            self.stopped_by = str(error)
            return self._standing()
        v = np.concatenate((base, np.zeros(3), rates))
        q = np.array(self._q)
        q[7:] += 0.5 * self._seconds * (self._v[6:] + rates)
        lower, upper = self._robot.joint_lower - LIMIT_TOLERANCE, self._robot.joint_upper + LIMIT_TOLERANCE
        beyond = np.flatnonzero((q[7:] < lower) | (q[7:] > upper))
        if beyond.size:
            self.stopped_by = f"teleop: {self._robot.joint_names[int(beyond[0])]} is at its limit"
            return self._standing()
        return v, self._kinematics.settled(q)

    def _standing(self) -> tuple[Vector, Vector]:
        self._twist = np.zeros(6)
        return np.zeros_like(self._v), self._q


def _shortened(vector: Vector, limit: float) -> Vector:
    length = hypot(*vector.tolist())
    return vector * (limit / length) if length > limit else vector
