"""What else happened in a run, whatever was expected of it: named beside the verdict, and never part of it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from space_robot_bringup.judge.metrics import Matrix
from space_robot_description.robot import Robot
from space_robot_description.spec import ReactionWheels
from space_robot_msgs_py.interfaces import NANOSECONDS, Vector

# Of the base, faster than its reference [rad/s], and for so long [s]: no task of a shipped robot turns it like this.
TUMBLING, TUMBLING_TIME = 0.3, 1.0
# Of its capacity: a wheel stops taking momentum there, rounded.
FULL = 1.0 - 1e-9
JOINT_LIMITS, WHEELS, MISSED, TUMBLED = "joint limits", "wheels full", "missed commands", "tumbling"
Stamps = npt.NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class Remark:
    """Something a reader of the verdict should know.

    Attributes:
        name: ``joint limits``, ``wheels full``, ``missed commands`` or ``tumbling``.
        text: what happened, with numbers, time and tick.
        since: of the first tick at which it is seen [ns].
    """

    name: str
    text: str
    since: int

    @property
    def line(self) -> str:
        """In one line."""
        return f"{self.name}: {self.text}"


@dataclass(slots=True)
class _Seen:
    """How often a condition was seen, since when, and the largest number that goes with it."""

    count: int = 0
    since: int = -1
    largest: float = 0.0
    which: int = 0

    def add(self, stamp: Stamps, holds: npt.NDArray[np.bool_], values: Matrix) -> None:
        """Take ticks: (K,) whether it holds, (K, size) the numbers."""
        rows = np.flatnonzero(holds)
        if not rows.size:
            return
        self.since = int(stamp[rows[0]]) if not self.count else self.since
        self.count += rows.size
        place = np.unravel_index(int(np.argmax(values[rows])), values[rows].shape)
        if values[rows][place] > self.largest:
            self.largest, self.which = float(values[rows][place]), int(place[1])


class Remarks:
    """Takes the ticks of a run block by block, of any sizes.

    Args:
        robot: the NOMINAL robot.
        period: control period [ns].
        delay: periods by which a command acts late.
    """

    def __init__(self, robot: Robot, period: int, delay: int) -> None:
        torque = robot.actuators.base_torque
        self._robot, self._period, self._delay = robot, period, delay
        self._capacity = torque.momentum if isinstance(torque, ReactionWheels) else np.inf
        self._seen = {name: _Seen() for name in (JOINT_LIMITS, WHEELS, MISSED, TUMBLED)}

    def add(self, stamp: Stamps, plant: Mapping[str, Matrix], v_d: Matrix) -> None:
        """Take the next ticks.

        Args:
            stamp: (K,) [ns].
            plant: telemetry of the plant by label, (K, size); of a block that is not there nothing is said.
            v_d: (K, 6+n) desired velocity.
        """
        if "joint_limit" in plant:
            beyond = np.abs(plant["joint_limit"])
            self._seen[JOINT_LIMITS].add(stamp, beyond.max(axis=1, initial=0.0) > 0.0, beyond)
        if "wheel_momentum" in plant:
            load = np.abs(plant["wheel_momentum"]) / self._capacity
            self._seen[WHEELS].add(stamp, load.max(axis=1, initial=0.0) >= FULL, load)
        if "command_stamp" in plant:
            answered = stamp - (1 + self._delay) * self._period
            acted = plant["command_stamp"][:, 0].astype(np.int64)
            self._seen[MISSED].add(stamp, (answered >= 0) & (acted != answered), np.zeros((stamp.size, 1)))
        if "true_velocity" in plant:
            rate = _length(plant["true_velocity"][:, 3:6] - v_d[:, 3:6])
            self._seen[TUMBLED].add(stamp, rate > TUMBLING, rate[:, None])

    def found(self) -> tuple[Remark, ...]:
        """What there is to say, in this order: joints, wheels, commands, base."""
        return tuple(Remark(name, text, self._seen[name].since) for name, text in self._texts())

    def _texts(self) -> Iterator[tuple[str, str]]:
        limits, wheels, missed, tumbled = self._seen.values()
        if limits.count:
            name, unit = self._robot.joint_names[limits.which], "m" if self._robot.prismatic[limits.which] else "rad"
            yield JOINT_LIMITS, f"{name} was up to {limits.largest:.3g} {unit} outside of them, {self._when(limits)}"
        if wheels.count:
            held = f"wheel {wheels.which} (from 0) held up to {wheels.largest * self._capacity:.4g} N m s"
            yield WHEELS, f"{held} of {self._capacity:g}, {self._when(wheels)}"
        if missed.count:
            yield MISSED, f"no answer to the state acted in {_periods(missed.count)}, {self._from(missed)}"
        if tumbled.count * self._period >= TUMBLING_TIME * NANOSECONDS:
            turned = f"the base turned up to {tumbled.largest:.3g} rad/s faster than was desired"
            yield TUMBLED, f"{turned}, above {TUMBLING:g} {self._when(tumbled)}"

    def _when(self, seen: _Seen) -> str:
        return f"for {seen.count * self._period / NANOSECONDS:g} s in all, {self._from(seen)}"

    def _from(self, seen: _Seen) -> str:
        return f"first at {seen.since / NANOSECONDS:g} s (tick {seen.since // self._period})"


def _length(rows: Matrix) -> Vector:
    length: Vector = np.sqrt((rows * rows).sum(axis=1))
    return length


def _periods(count: int) -> str:
    return "one period" if count == 1 else f"{count} periods"
