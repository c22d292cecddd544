"""A log as arrays over time, cut out of the messages without decoding them one by one."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from space_robot_msgs_py.codec.codecs import (
    CommandCodec,
    ReferenceCodec,
    StateCodec,
    TelemetryCodec,
    WheelMomentumCodec,
)
from space_robot_msgs_py.codec.layout import Layout
from space_robot_msgs_py.errors import LayoutError, LogError, NonFiniteError
from space_robot_msgs_py.interfaces import NANOSECONDS, Telemetry, Tick, Vector
from space_robot_msgs_py.topics import CONTROLLER_TELEMETRY, PLANT_TELEMETRY, WHEEL_MOMENTUM, Topic

Row = tuple[int, dict[str, bytes]]
Stamps = npt.NDArray[np.int64]


@dataclass(frozen=True, eq=False, slots=True)
class LogArrays:
    """K complete ticks of a robot with n joints; names as in the value types.

    Attributes:
        stamp: (K,) [ns].
        time: (K,) [s].
        q: (K, 7+n) measured configuration.
        v: (K, 6+n) measured velocity.
        effort: (K, n) measured motor effort.
        base_acceleration: (K, 3) measured.
        q_d: (K, 7+n) desired configuration.
        v_d: (K, 6+n) desired velocity.
        a_d: (K, 6+n) desired acceleration.
        wrench: (K, 6) commanded force and torque on the base.
        effort_command: (K, n) commanded joint effort.
        controller: (K, size) telemetry of the controller by label.
        plant: (K, size) telemetry of the plant by label.
        wheel_momentum: (K, 3) measured; None: it was not.
    """

    stamp: npt.NDArray[np.int64]
    time: Vector
    q: Vector
    v: Vector
    effort: Vector
    base_acceleration: Vector
    q_d: Vector
    v_d: Vector
    a_d: Vector
    wrench: Vector
    effort_command: Vector
    controller: dict[str, Vector]
    plant: dict[str, Vector]
    wheel_momentum: Vector | None = None


def stack_ticks(rows: Sequence[Row], joint_names: Sequence[str], key: str, *, one_stamp: bool = False) -> LogArrays:
    """Stack the ticks of a log.

    Args:
        rows: stamp [ns] and messages by topic name of each tick.
        joint_names: the robot's joints in model order.
        key: the file, for error messages.
        one_stamp: the stamps in the messages must be those of the rows.

    Raises:
        LayoutError: a stamp in a message is another one.
        LogError: a message does not fit, or the shape of telemetry changes.
        NonFiniteError: a number is NaN or infinite.
    """
    stamp = np.array([at for at, _ in rows], dtype=np.int64)
    wanted = stamp if one_stamp else None
    try:
        state = [_stack(rows, *one, wanted) for one in _parts(StateCodec(joint_names))]
        wheels = _stack_wheels(rows, wanted)
        reference = [_stack(rows, *one, wanted) for one in _parts(ReferenceCodec(joint_names))]
        command = [_stack(rows, *one, wanted) for one in _parts(CommandCodec(joint_names))]
        controller = _stack_telemetry(rows, CONTROLLER_TELEMETRY, wanted)
        plant = _stack_telemetry(rows, PLANT_TELEMETRY, wanted)
    except ValueError as error:
        if isinstance(error, NonFiniteError):
            raise
        raise LogError(f"the messages of a topic differ: {error}", key=key) from None
    (pose, twist), (position, velocity, effort), (_, _, acceleration) = state
    (pose_d, twist_d), (accel_d,), (position_d, velocity_d, acceleration_d) = reference
    return LogArrays(
        stamp=stamp,
        time=stamp / NANOSECONDS,
        q=np.hstack([pose, position]),
        v=np.hstack([twist, velocity]),
        effort=effort,
        base_acceleration=acceleration,
        q_d=np.hstack([pose_d, position_d]),
        v_d=np.hstack([twist_d, velocity_d]),
        a_d=np.hstack([accel_d, acceleration_d]),
        wrench=command[0][0],
        effort_command=command[1][0],
        controller=controller,
        plant=plant,
        wheel_momentum=wheels,
    )


def arrays_of(ticks: Sequence[Tick]) -> LogArrays:
    """Stack ticks that were never written; bit for bit what a log of them would give.

    Args:
        ticks: at least one.

    Raises:
        LayoutError: the layout of telemetry changes, or only some ticks have the momentum of the wheels.
    """
    states, references = [tick.sample.state for tick in ticks], [tick.reference for tick in ticks]
    wheels = [state.wheel_momentum for state in states if state.wheel_momentum is not None]
    _check_all(WHEEL_MOMENTUM, len(wheels), len(ticks))
    commands = [tick.output.command for tick in ticks]
    stamp = np.array([state.stamp for state in states], dtype=np.int64)
    return LogArrays(
        stamp=stamp,
        time=stamp / NANOSECONDS,
        q=np.array([state.q for state in states]),
        v=np.array([state.v for state in states]),
        effort=np.array([state.effort for state in states]),
        base_acceleration=np.array([state.base_acceleration for state in states]),
        q_d=np.array([reference.q for reference in references]),
        v_d=np.array([reference.v for reference in references]),
        a_d=np.array([reference.a for reference in references]),
        wrench=np.array([command.wrench for command in commands]),
        effort_command=np.array([command.effort for command in commands]),
        controller=stack_telemetry([tick.output.telemetry for tick in ticks]),
        plant=stack_telemetry([tick.sample.telemetry for tick in ticks]),
        wheel_momentum=np.array(wheels) if wheels else None,
    )


def stack_telemetry(telemetry: Sequence[Telemetry], needed: Iterable[str] = ()) -> dict[str, Vector]:
    """Stack telemetry of one layout, at least one: block name to (K, size).

    Args:
        telemetry: of a run.
        needed: blocks that have to be there.

    Raises:
        LayoutError: the layout changes, or a block is missing.
    """
    labels, sizes = telemetry[0].labels, telemetry[0].sizes
    for one in telemetry:
        if (one.labels, one.sizes) != (labels, sizes):
            raise LayoutError("the blocks change within a run", key="telemetry", value=f"at {one.stamp} ns")
    if missing := [label for label in needed if label not in labels]:
        raise LayoutError("no such block", key="telemetry", value=missing[0], accepted=", ".join(labels))
    return _blocks(labels, sizes, np.array([one.data for one in telemetry]))


def _blocks(labels: Sequence[str], sizes: Sequence[int], data: Vector) -> dict[str, Vector]:
    edges = np.cumsum((0, *sizes))
    return {label: data[:, a:b] for label, a, b in zip(labels, edges[:-1], edges[1:], strict=True)}


def _parts(codec: StateCodec | WheelMomentumCodec | ReferenceCodec | CommandCodec) -> list[tuple[Topic, Layout]]:
    return list(zip(codec.topics, codec.layouts, strict=True))


def _stack(rows: Sequence[Row], topic: Topic, layout: Layout, wanted: Stamps | None) -> list[Vector]:
    """The arrays of a topic over time, without the stamp, which has to be the wanted one if there is one."""
    stamps, *arrays = layout.stack([parts[topic.name] for _, parts in rows])
    if wanted is not None and (_nanoseconds(stamps) != wanted).any():
        raise LayoutError("parts of different stamps", key=topic.name, accepted="one stamp")
    for array in arrays:
        if not np.isfinite(array).all():
            raise NonFiniteError("not a finite number in the log", key=topic.name)
    return arrays


def _nanoseconds(stamps: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Stamps as they stand in messages, seconds and nanoseconds or one number, as [ns]."""
    if stamps.shape[1] == 1:
        return stamps[:, 0]
    seconds, rest = stamps.astype(np.int64).T
    nanoseconds: Stamps = seconds * NANOSECONDS + rest
    return nanoseconds


def _stack_wheels(rows: Sequence[Row], wanted: Stamps | None) -> Vector | None:
    """The momentum of the wheels over time; None where it was not measured."""
    if not _check_all(WHEEL_MOMENTUM, sum(WHEEL_MOMENTUM.name in parts for _, parts in rows), len(rows)):
        return None
    ((topic, layout),) = _parts(WheelMomentumCodec())
    return _stack(rows, topic, layout, wanted)[0]


def _check_all(topic: Topic, present: int, ticks: int) -> bool:
    """Whether the ticks have messages of a topic, which must be all of them or none."""
    if present not in (0, ticks):
        raise LayoutError("at some ticks only", key=topic.name, value=f"{present} of {ticks}")
    return present > 0


def _stack_telemetry(rows: Sequence[Row], topic: Topic, wanted: Stamps | None) -> dict[str, Vector]:
    """The blocks of telemetry over time by label; nothing where the run has none."""
    present = [parts[topic.name] for _, parts in rows if topic.name in parts]
    if not _check_all(topic, len(present), len(rows)):
        return {}
    codec = TelemetryCodec(topic)
    labels, sizes = codec.shape(present[0])
    (data,) = _stack(rows, topic, codec.layout_of(present[0]), wanted)
    return _blocks(labels, sizes, data)
