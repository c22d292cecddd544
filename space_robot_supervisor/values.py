"""What a monitor may read: numbers by name, of what the flight software knows at a tick, and nothing of the truth."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import isfinite
from typing import NamedTuple

import numpy as np

from space_robot_description.robot import Robot
from space_robot_description.spec import ReactionWheels
from space_robot_description.validation import nearest
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Command, Reference, RobotState, Telemetry, Vector
from space_robot_supervisor.kernel import readings

TELEMETRY, WHEELS = "telemetry.", "wheels.momentum"
# What the plant's command monitor counts.
COUNTS = ("command.missed", "command.refused", "command.clipped")
_XYZ = ("x", "y", "z")
_SINGLE = {
    "base.rate": readings.BASE_RATE,
    "base.speed": readings.BASE_SPEED,
    "joints.rate": readings.JOINT_RATE,
    "error.position": readings.OFF_POSITION,
    "error.attitude": readings.OFF_ATTITUDE,
    "error.joints": readings.OFF_JOINTS,
    "command.saturation": readings.SATURATION,
}


class Snapshot(NamedTuple):
    """What is known when a state arrives.

    Attributes:
        state: measured.
        reference: of the same stamp, as guidance gave it.
        command: the last one of the controller; None at the first tick.
        telemetry: that came with it.
        wheels: (3,) momentum of the nominal wheels, measured or dead-reckoned from the commands [N m s].
        counts: of the plant's command monitor, by name.
    """

    state: RobotState
    reference: Reference
    command: Command | None = None
    telemetry: Telemetry | None = None
    wheels: Vector | None = None
    counts: Mapping[str, int] | None = None


class Value(NamedTuple):
    """Where a number is found.

    Attributes:
        kind: see ``kernel.readings``.
        place: of a single number in its source.
        label: of a block of telemetry.
        number: place of one number in the block; None: its largest magnitude.
    """

    kind: int
    place: int = 0
    label: str = ""
    number: int | None = None

    @property
    def of_wheels(self) -> bool:
        """It is the momentum of the wheels."""
        return bool(self.kind == readings.WHEELS)

    @property
    def of_counts(self) -> bool:
        """It is counted by the plant's command monitor."""
        return bool(self.kind == readings.COUNT)

    def row(self, telemetry: Telemetry | None) -> tuple[int, int, int]:
        """Kind, begin and end for kernels, where telemetry is laid out like this; None: there is none yet."""
        if not self.label:
            return self.kind, self.place, self.place + 1
        if telemetry is None or self.label not in telemetry.labels:
            return self.kind, -1, -1
        block = telemetry.labels.index(self.label)
        begin, size = sum(telemetry.sizes[:block]), telemetry.sizes[block]
        if self.number is None:
            return self.kind, begin, begin + size
        return (self.kind, begin + self.number, begin + size) if self.number < size else (self.kind, -1, -1)


def value_of(name: str, robot: Robot, labels: Sequence[str], key: str, *, counted: bool = False) -> Value:
    """Where a value is found.

    Args:
        name: of the value.
        robot: the NOMINAL robot.
        labels: of the controller's telemetry.
        key: of the monitor's row, for errors.
        counted: the plant's command monitor counts.

    Raises:
        SpecError: there is no such value; with the nearest names.
    """
    if name.startswith(TELEMETRY):
        return _telemetry(name, labels, key)
    if name in COUNTS:
        if not counted:
            raise SpecError("nothing counts it", key=key, value=name, accepted="plant.monitor in the experiment")
        return Value(readings.COUNT, COUNTS.index(name))
    known = values_of(robot)
    if name not in known:
        accepted = nearest(name, (*known, *COUNTS)) or ", ".join([*known, *COUNTS, f"{TELEMETRY}LABEL"])
        raise SpecError("no such value", key=key, value=name, accepted=accepted)
    return known[name]


def values_of(robot: Robot) -> dict[str, Value]:
    """Every value of a robot by name, but those of telemetry and the counts."""
    found = {name: Value(kind) for name, kind in _SINGLE.items()}
    if any(map(isfinite, (*robot.joint_lower.tolist(), *robot.joint_upper.tolist()))):
        found["joints.margin"] = Value(readings.MARGIN)
    if isinstance(robot.actuators.base_torque, ReactionWheels):
        found[WHEELS] = Value(readings.WHEELS)
    parts = {"position": (0, _XYZ), "attitude": (3, (*_XYZ, "w")), "joint.position": (7, robot.joint_names)}
    for part, (first, names) in parts.items():
        found |= {f"{part}.{name}": Value(readings.POSITION, first + index) for index, name in enumerate(names)}
    rates = {"rate": (3, _XYZ), "joint.rate": (6, robot.joint_names)}
    for part, (first, names) in rates.items():
        found |= {f"{part}.{name}": Value(readings.RATE, first + index) for index, name in enumerate(names)}
    return found


def counts_of(found: Mapping[str, int]) -> Vector:
    """(3,) counts in the order of ``COUNTS``."""
    return np.array([found.get(name, 0) for name in COUNTS], dtype=np.float64)


def _telemetry(name: str, labels: Sequence[str], key: str) -> Value:
    """The largest magnitude of a block; ``telemetry.LABEL.INDEX`` is one number of it."""
    label, index = name.removeprefix(TELEMETRY), None
    if label not in labels and "." in label and label.rpartition(".")[2].isdecimal():
        label, index = label.rpartition(".")[0], int(label.rpartition(".")[2])
    if label not in labels:
        accepted = nearest(label, labels) or ", ".join(labels) or "a law with telemetry"
        raise SpecError("no such block of telemetry", key=key, value=name, accepted=accepted)
    return Value(readings.BLOCK if index is None else readings.NUMBER, 0, label, index)
