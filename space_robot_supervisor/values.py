"""What a monitor may read: numbers by name, of what the flight software knows at a tick, and nothing of the truth."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import atan2, isfinite, sqrt
from operator import sub

from space_robot_description.robot import Robot
from space_robot_description.rotations import relative
from space_robot_description.spec import ReactionWheels
from space_robot_description.validation import nearest
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Command, Reference, RobotState, Telemetry, Vector

TELEMETRY = "telemetry."
WHEELS = "wheels.momentum"
# What the plant's command monitor counts.
COUNTS = ("command.missed", "command.refused", "command.clipped")
_XYZ = ("x", "y", "z")


class Snapshot:
    """What is known when a state arrives.

    Args:
        state: measured.
        reference: of the same stamp, as guidance gave it.
        command: the last one of the controller; None at the first tick.
        telemetry: that came with it.
        wheels: (3,) momentum of the nominal wheels, measured or dead-reckoned from the commands [N m s].
        counts: of the plant's command monitor, by name.

    Attributes:
        q: configuration of the state.
        v: velocity of the state.
        q_d: configuration of the reference.
    """

    # Lists of floats: of so few numbers several times faster than NumPy.
    __slots__ = ("command", "counts", "q", "q_d", "reference", "state", "telemetry", "v", "wheels")

    def __init__(
        self,
        state: RobotState,
        reference: Reference,
        command: Command | None = None,
        telemetry: Telemetry | None = None,
        wheels: Vector | None = None,
        counts: Mapping[str, int] | None = None,
    ) -> None:
        self.state, self.reference, self.command, self.telemetry = state, reference, command, telemetry
        self.wheels, self.counts = wheels, counts
        self.q: list[float] = state.q.tolist()
        self.v: list[float] = state.v.tolist()
        self.q_d: list[float] = reference.q.tolist()


# None: there is no such number yet.
Value = Callable[[Snapshot], float | None]


def value_of(
    name: str, robot: Robot, labels: Sequence[str], limit: Vector, key: str, *, counted: bool = False
) -> Value:
    """The function that reads a value.

    Args:
        name: of the value.
        robot: the NOMINAL robot.
        labels: of the controller's telemetry.
        limit: (6+n,) of its actuators, infinite where there is none.
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
        return lambda now: None if now.counts is None else float(now.counts.get(name, 0))
    known = values_of(robot, limit)
    if name not in known:
        accepted = nearest(name, (*known, *COUNTS)) or ", ".join([*known, *COUNTS, f"{TELEMETRY}LABEL"])
        raise SpecError("no such value", key=key, value=name, accepted=accepted)
    return known[name]


def values_of(robot: Robot, limit: Vector) -> dict[str, Value]:
    """Every value of a robot by name, but those of telemetry and the counts."""
    bounds = [(index, most) for index, most in enumerate(limit.tolist()) if isfinite(most)]
    found: dict[str, Value] = {
        "base.rate": lambda now: _norm(*now.v[3:6]),
        "base.speed": lambda now: _norm(*now.v[:3]),
        "joints.rate": _joint_rate(robot.n),
        "error.position": lambda now: _norm(*map(sub, now.q_d[:3], now.q)),
        "error.attitude": lambda now: _angle(now.q[3:7], now.q_d[3:7]),
        "error.joints": lambda now: max(map(abs, map(sub, now.q_d[7:], now.q[7:])), default=0.0),
        "command.saturation": lambda now: None if now.command is None else _saturated(now.command, bounds),
    }
    ends = _ends(robot)
    if ends:
        found["joints.margin"] = _margin(ends)
    if isinstance(robot.actuators.base_torque, ReactionWheels):
        found[WHEELS] = lambda now: None if now.wheels is None else _norm(*now.wheels.tolist())
    parts = {"position": (0, _XYZ), "attitude": (3, (*_XYZ, "w")), "joint.position": (7, robot.joint_names)}
    for part, (first, names) in parts.items():
        found |= {f"{part}.{name}": _position(first + index) for index, name in enumerate(names)}
    rates = {"rate": (3, _XYZ), "joint.rate": (6, robot.joint_names)}
    for part, (first, names) in rates.items():
        found |= {f"{part}.{name}": _rate(first + index) for index, name in enumerate(names)}
    return found


def _joint_rate(joints: int) -> Value:
    def read(now: Snapshot) -> float:
        rates = now.v[6:]
        # Zero first: of equal ones the first counts, and a magnitude is no negative zero.
        return max(0.0, max(rates), -min(rates))

    return read if joints else lambda now: 0.0


def _margin(ends: Sequence[tuple[int, float, float]]) -> Value:
    def read(now: Snapshot) -> float:
        q = now.q
        return min([q[i] - low if q[i] - low < high - q[i] else high - q[i] for i, low, high in ends])

    return read


def _ends(robot: Robot) -> list[tuple[int, float, float]]:
    """Place in a configuration, lower and upper limit of every joint that has one."""
    limits = zip(robot.joint_lower.tolist(), robot.joint_upper.tolist(), strict=True)
    return [(7 + i, low, high) for i, (low, high) in enumerate(limits) if isfinite(low) or isfinite(high)]


def _position(index: int) -> Value:
    return lambda now: now.q[index]


def _rate(index: int) -> Value:
    return lambda now: now.v[index]


def _telemetry(name: str, labels: Sequence[str], key: str) -> Value:
    """The largest magnitude of a block; ``telemetry.LABEL.INDEX`` is one number of it."""
    label, index = name.removeprefix(TELEMETRY), None
    if label not in labels and "." in label and label.rpartition(".")[2].isdecimal():
        label, index = label.rpartition(".")[0], int(label.rpartition(".")[2])
    if label not in labels:
        accepted = nearest(label, labels) or ", ".join(labels) or "a law with telemetry"
        raise SpecError("no such block of telemetry", key=key, value=name, accepted=accepted)
    return _Block(label, index).read


class _Block:
    """One block of telemetry, found once: labels and sizes stay the same for a whole run."""

    def __init__(self, label: str, index: int | None) -> None:
        self._label, self._index = label, index
        self._labels: tuple[str, ...] = ()
        self._place: slice | None = None

    def read(self, now: Snapshot) -> float | None:
        """The number, or the largest magnitude."""
        telemetry = now.telemetry
        if telemetry is None:
            return None
        if telemetry.labels is not self._labels:
            self._find(telemetry)
        if self._place is None:
            return None
        block: list[float] = telemetry.data[self._place].tolist()
        if self._index is None:
            return max(map(abs, block), default=0.0)
        return block[self._index] if self._index < len(block) else None

    def _find(self, telemetry: Telemetry) -> None:
        self._labels, self._place = telemetry.labels, None
        if self._label in telemetry.labels:
            place = telemetry.labels.index(self._label)
            start = sum(telemetry.sizes[:place])
            self._place = slice(start, start + telemetry.sizes[place])


def _saturated(command: Command, bounds: Sequence[tuple[int, float]]) -> float:
    u = command.wrench.tolist() + command.effort.tolist()
    return len([1 for index, most in bounds if not -most < u[index] < most]) / len(bounds)


def _angle(q: Sequence[float], desired: Sequence[float]) -> float:
    x, y, z, w = relative(q, desired)
    return 2.0 * atan2(_norm(x, y, z), w)


def _norm(x: float, y: float, z: float) -> float:
    return sqrt(x * x + y * y + z * z)
