"""The values that flow: what the arrows of the data flow carry. Conventions are those of ``interfaces``."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from space_robot_msgs_py.errors import LayoutError
from space_robot_msgs_py.events import ControllerEvent, DiagnosticEvent
from space_robot_msgs_py.vectors import Vector, vector

NANOSECONDS = 1_000_000_000


def _freeze(instance: object, **fields: Any) -> None:
    for name, value in fields.items():
        object.__setattr__(instance, name, value)


@dataclass(frozen=True, eq=False, slots=True)
class RobotState:
    """What the flight software measures at one stamp.

    Attributes:
        stamp: [ns].
        q: (7+n,) configuration [m, -, rad].
        v: (6+n,) velocity, base twist in the body frame [m/s, rad/s].
        effort: (n,) motor effort at the joints, mean over the control period that ended at this stamp [N m or N].
        base_acceleration: (3,) inertial acceleration of the base origin, body frame, as an accelerometer reads it
            [m/s2].
        wheel_momentum: (3,) momentum of the reaction wheels relative to the base, body frame [N m s]; None: it is not
            measured.
    """

    stamp: int
    q: Vector
    v: Vector
    effort: Vector
    base_acceleration: Vector
    wheel_momentum: Vector | None = None

    def __post_init__(self) -> None:
        n = np.size(self.effort)
        _freeze(
            self,
            q=vector(self.q, 7 + n, "state.q"),
            v=vector(self.v, 6 + n, "state.v"),
            effort=vector(self.effort, n, "state.effort"),
            base_acceleration=vector(self.base_acceleration, 3, "state.base_acceleration"),
        )
        if self.wheel_momentum is not None:
            _freeze(self, wheel_momentum=vector(self.wheel_momentum, 3, "state.wheel_momentum"))

    @property
    def joints(self) -> Vector:
        """(n,) joint positions [rad or m]."""
        return self.q[7:]

    @property
    def joint_rates(self) -> Vector:
        """(n,) joint velocities [rad/s or m/s]."""
        return self.v[6:]


@dataclass(frozen=True, eq=False, slots=True)
class Reference:
    """What is asked of the robot at one stamp; q, v as in RobotState, a = dv/dt componentwise, all of the DESIRED body.

    Attributes:
        stamp: [ns].
        q: (7+n,) desired configuration [m, -, rad].
        v: (6+n,) desired velocity, base twist in the desired body frame [m/s, rad/s].
        a: (6+n,) derivative of the components of v [m/s2, rad/s2].
    """

    stamp: int
    q: Vector
    v: Vector
    a: Vector

    def __post_init__(self) -> None:
        n = np.size(self.q) - 7
        _freeze(
            self,
            q=vector(self.q, 7 + n, "reference.q"),
            v=vector(self.v, 6 + n, "reference.v"),
            a=vector(self.a, 6 + n, "reference.a"),
        )


@dataclass(frozen=True, eq=False, slots=True)
class Command:
    """What the flight software orders; the stamp is that of the state it answers.

    Attributes:
        stamp: [ns].
        wrench: (6,) force then torque on the base, body frame, at the base origin [N, N m].
        effort: (n,) joint efforts [N m or N].
    """

    stamp: int
    wrench: Vector
    effort: Vector

    def __post_init__(self) -> None:
        _freeze(
            self,
            wrench=vector(self.wrench, 6, "command.wrench"),
            effort=vector(self.effort, None, "command.effort"),
        )

    @property
    def u(self) -> Vector:
        """(6+n,) generalised force [force, torque, efforts], dual to v."""
        return np.concatenate([self.wrench, self.effort])


@dataclass(frozen=True, eq=False, slots=True)
class Telemetry:
    """Labelled blocks of numbers at one stamp; labels and sizes stay the same for a whole run.

    Attributes:
        stamp: [ns].
        labels: block names, e.g. ``("sliding_surface", "estimate")``.
        sizes: length of each block.
        data: (sum(sizes),) the blocks one after the other.
    """

    stamp: int
    labels: tuple[str, ...]
    sizes: tuple[int, ...]
    data: Vector

    def __post_init__(self) -> None:
        _freeze(self, data=vector(self.data, sum(self.sizes), "telemetry"))

    @classmethod
    def of(cls, stamp: int, blocks: Mapping[str, npt.ArrayLike]) -> Telemetry:
        """Build from an ordered mapping of block name to scalar or 1-D array."""
        parts = [_flat(block) for block in blocks.values()]
        data = np.concatenate(parts) if parts else np.empty(0)
        return cls(stamp, tuple(blocks), tuple(map(len, parts)), data)

    def __getitem__(self, label: str) -> Vector:
        """The block of that name.

        Raises:
            LayoutError: there is none.
        """
        if label not in self.labels:
            raise LayoutError("no such block", key="telemetry", value=label, accepted=", ".join(self.labels))
        index = self.labels.index(label)
        start = sum(self.sizes[:index])
        return self.data[start : start + self.sizes[index]]

    def items(self) -> Iterator[tuple[str, Vector]]:
        """(label, block) pairs in order."""
        start = 0
        for label, size in zip(self.labels, self.sizes, strict=True):
            yield label, self.data[start : start + size]
            start += size


def _flat(block: Any) -> Vector | tuple[float]:
    # A lone number stays one: making an array of each would take longer than all the rest.
    if isinstance(block, float):
        return (block,)
    array = np.asarray(block, dtype=np.float64)
    return array if array.ndim else array.reshape(1)


@dataclass(frozen=True, slots=True)
class ControlOutput:
    """What a controller answers to a state.

    Attributes:
        command: to the plant.
        telemetry: what the law wants to be seen of how it came about.
        events: what has changed since the command before.
    """

    command: Command
    telemetry: Telemetry
    events: tuple[ControllerEvent, ...] = ()


@dataclass(frozen=True, eq=False, slots=True)
class Supervision:
    """What a supervisor decides at one stamp.

    Attributes:
        stamp: [ns].
        mode: that holds from this stamp on.
        law: that answers: ``controller`` is that of the experiment, any other one is the mode's own.
        reference: that it follows: ``follow`` (guidance's), ``freeze`` (guidance's at the entry), ``here`` (the
            measured configuration at the entry).
        since: stamp of the entry [ns].
        answer: stamp of the newest answer of the controller that was known [ns]; -1: none.
        events: what was found at this stamp, and what was done about it.
        housekeeping: a summary, where one is due.
        brakes: the brakes of all joints are closed.
        unload: thrusters unload the wheels.
    """

    stamp: int
    mode: str
    law: str
    reference: str
    since: int
    answer: int = -1
    events: tuple[DiagnosticEvent, ...] = ()
    housekeeping: Telemetry | None = None
    brakes: bool = False
    unload: bool = False


@dataclass(frozen=True, slots=True)
class PlantSample:
    """What the plant shows at one stamp.

    Attributes:
        state: what is measured.
        telemetry: the truth.
        faults: what begins and ends to be wrong with the robot at this stamp; the truth, too.
        events: what the plant did not take of the command that answers the state before, or not as it was.
    """

    state: RobotState
    telemetry: Telemetry
    faults: tuple[DiagnosticEvent, ...] = ()
    events: tuple[DiagnosticEvent, ...] = ()


@dataclass(frozen=True, slots=True)
class Tick:
    """Everything that belongs to one stamp: one row of the log."""

    sample: PlantSample
    reference: Reference
    output: ControlOutput
    supervision: Supervision | None = None

    @property
    def stamp(self) -> int:
        """[ns]."""
        return self.sample.state.stamp

    @property
    def diagnostics(self) -> tuple[DiagnosticEvent, ...]:
        """What happens: to the robot, to its commands, and what a supervisor found, in this order."""
        found = () if self.supervision is None else self.supervision.events
        return (*self.sample.faults, *self.sample.events, *found)


@dataclass(frozen=True, slots=True)
class Acknowledgement:
    """The answer to a command of the ground.

    Attributes:
        accepted: it will act.
        reason: why not; or what will happen.
    """

    accepted: bool
    reason: str
