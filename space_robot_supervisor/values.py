"""What a monitor may read: numbers by name, of what the flight software knows at a tick, and nothing of the truth."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import isfinite, sqrt

from space_robot_description.robot import Robot
from space_robot_description.rotations import log, relative
from space_robot_description.spec import ReactionWheels
from space_robot_description.validation import nearest
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Command, Reference, RobotState, Telemetry, Vector

TELEMETRY = "telemetry."
_XYZ = ("x", "y", "z")


@dataclass(frozen=True, eq=False, slots=True)
class Snapshot:
    """What is known when a state arrives.

    Attributes:
        state: measured.
        reference: of the same stamp, as guidance gave it.
        command: the last one of the controller; None at the first tick.
        telemetry: that came with it.
        wheels: (3,) momentum of the nominal wheels, dead-reckoned from the commands [N m s].
    """

    state: RobotState
    reference: Reference
    command: Command | None = None
    telemetry: Telemetry | None = None
    wheels: Vector | None = None


# None: there is no such number yet.
Value = Callable[[Snapshot], float | None]


def value_of(name: str, robot: Robot, labels: Sequence[str], limit: Vector, key: str) -> Value:
    """The function that reads a value.

    Args:
        name: of the value.
        robot: the NOMINAL robot.
        labels: of the controller's telemetry.
        limit: (6+n,) of its actuators, infinite where there is none.
        key: of the monitor's row, for errors.

    Raises:
        SpecError: there is no such value; with the nearest names.
    """
    if name.startswith(TELEMETRY):
        return _telemetry(name, labels, key)
    known = values_of(robot, limit)
    if name not in known:
        accepted = nearest(name, known) or ", ".join([*known, f"{TELEMETRY}LABEL"])
        raise SpecError("no such value", key=key, value=name, accepted=accepted)
    return known[name]


def values_of(robot: Robot, limit: Vector) -> dict[str, Value]:
    """Every value of a robot by name, but those of telemetry."""
    bounds = [(index, most) for index, most in enumerate(limit.tolist()) if isfinite(most)]
    found: dict[str, Value] = {
        "base.rate": lambda now: _length(now.state.v[3:6]),
        "base.speed": lambda now: _length(now.state.v[:3]),
        "joints.rate": lambda now: _largest(now.state.joint_rates),
        "error.position": lambda now: _length(now.reference.q[:3] - now.state.q[:3]),
        "error.attitude": lambda now: _norm(log(relative(now.state.q[3:7], now.reference.q[3:7]))),
        "error.joints": lambda now: _largest(now.reference.q[7:] - now.state.joints),
        "command.saturation": lambda now: None if now.command is None else _saturated(now.command, bounds),
    }
    if isinstance(robot.actuators.base_torque, ReactionWheels):
        found["wheels.momentum"] = lambda now: None if now.wheels is None else _length(now.wheels)
    parts: Mapping[str, tuple[Callable[[Snapshot], Vector], Sequence[str]]] = {
        "position": (lambda now: now.state.q[:3], _XYZ),
        "attitude": (lambda now: now.state.q[3:7], (*_XYZ, "w")),
        "rate": (lambda now: now.state.v[3:6], _XYZ),
        "joint.position": (lambda now: now.state.joints, robot.joint_names),
        "joint.rate": (lambda now: now.state.joint_rates, robot.joint_names),
    }
    for part, (read, names) in parts.items():
        found |= {f"{part}.{name}": _entry(read, index) for index, name in enumerate(names)}
    return found


def _entry(read: Callable[[Snapshot], Vector], index: int) -> Value:
    return lambda now: float(read(now)[index])


def _telemetry(name: str, labels: Sequence[str], key: str) -> Value:
    """The largest magnitude of a block; ``telemetry.LABEL.INDEX`` is one number of it."""
    label, index = name.removeprefix(TELEMETRY), None
    if label not in labels and "." in label and label.rpartition(".")[2].isdecimal():
        label, index = label.rpartition(".")[0], int(label.rpartition(".")[2])
    if label not in labels:
        accepted = nearest(label, labels) or ", ".join(labels) or "a law with telemetry"
        raise SpecError("no such block of telemetry", key=key, value=name, accepted=accepted)

    def read(now: Snapshot) -> float | None:
        if now.telemetry is None or label not in now.telemetry.labels:
            return None
        block = now.telemetry[label]
        if index is None:
            return _largest(block)
        return float(block[index]) if index < block.size else None

    return read


def _saturated(command: Command, bounds: Sequence[tuple[int, float]]) -> float:
    u = command.u.tolist()
    return float(sum(abs(u[index]) >= most for index, most in bounds) / len(bounds))


# On Python's floats: of so few numbers several times faster than NumPy.
def _length(vector: Vector) -> float:
    return _norm(vector.tolist())


def _norm(parts: Sequence[float]) -> float:
    return sqrt(sum([part * part for part in parts]))


def _largest(vector: Vector) -> float:
    return float(max(map(abs, vector.tolist()), default=0.0))
