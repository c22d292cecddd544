"""State, reference and command to and from the canonical bytes of their topics, in table order."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite
from typing import ClassVar, Generic, TypeVar

import numpy as np

from space_robot_msgs_py.codec import message_layouts as standard
from space_robot_msgs_py.codec.by_name import conformed
from space_robot_msgs_py.codec.cdr import pack_stamp, stamp_of, unpack_stamp
from space_robot_msgs_py.codec.layout import Layout
from space_robot_msgs_py.codec.texts import peek_stamp
from space_robot_msgs_py.errors import CommandError, LayoutError, NonFiniteError
from space_robot_msgs_py.interfaces import Command, Reference, RobotState
from space_robot_msgs_py.limits import MESSAGE_SLACK
from space_robot_msgs_py.topics import (
    BASE_IMU,
    BASE_ODOM,
    JOINT_COMMAND,
    JOINT_STATES,
    REFERENCE_BASE,
    REFERENCE_BASE_ACCEL,
    REFERENCE_JOINTS,
    WRENCH_COMMAND,
    Topic,
    topics_of,
)


def check_size(layout: Layout, raw: bytes) -> None:
    """Refuse a message that is far longer than what is expected, before anything of it is read or kept.

    Raises:
        LayoutError: with the limit.
    """
    if len(raw) > layout.size + MESSAGE_SLACK.most:
        raise MESSAGE_SLACK.exceeded(layout.topic, len(raw) - layout.size, LayoutError)


V = TypeVar("V")
Blocks = Sequence[bytes]


def all_finite(blocks: Blocks) -> bool:
    """True where no number of a part is NaN or infinite."""
    numbers = memoryview(b"".join(blocks)).cast("d")
    # The sum tells nearly always; that of huge numbers may be infinite without any of them.
    return isfinite(sum(numbers)) or all(map(isfinite, numbers))


def value_of(kind: type[V], *fields: object) -> V:
    """A frozen value without the checks of its class, which take half of the time of reading one.

    Args:
        kind: of the value.
        fields: all of them, in order: arrays on bytes, finite and of the sizes of a layout.
    """
    value = object.__new__(kind)
    for name, field in zip(kind.__slots__, fields, strict=True):  # type: ignore[attr-defined]
        object.__setattr__(value, name, field)
    return value


class PartsCodec(Generic[V]):
    """What the codecs of state, reference and command share: a value is several messages of one stamp.

    Attributes:
        topics: the topics of the parts, in table order.
        layouts: their layouts.
    """

    topics: ClassVar[tuple[Topic, ...]]
    layouts: tuple[Layout, ...]

    def encode(self, value: V) -> tuple[bytes, ...]:
        """The messages of a value, in the order of ``topics``.

        Raises:
            LayoutError: a part of the value has the wrong size (CommandError for commands).
        """
        raise NotImplementedError

    def decode(self, parts: Sequence[bytes]) -> V:
        """The value in these messages, which are in the order of ``topics``.

        Raises:
            LayoutError: a part has another layout (CommandError for commands), or the stamps differ.
            NonFiniteError: a number is NaN or infinite.
        """
        blocks = [self._blocks(index, part) for index, part in enumerate(parts)]
        if len({block[0] for block in blocks}) > 1:
            stamps = [unpack_stamp(block[0]) for block in blocks]
            names = ", ".join(topic.name for topic in self.topics)
            raise LayoutError("parts of different stamps", key=names, value=stamps, accepted="one stamp")
        return self.join(unpack_stamp(blocks[0][0]), [block[1:] for block in blocks])

    def peek(self, index: int, raw: bytes) -> int:
        """The stamp [ns] of one part, and nothing else of it is looked at.

        Raises:
            LayoutError: the message is far longer than this robot's, or has no stamp.
        """
        layout = self.layouts[index]
        check_size(layout, raw)
        return peek_stamp(raw)

    def decode_part(self, index: int, raw: bytes) -> tuple[int, Blocks]:
        """The stamp [ns] of one part and the bytes of its arrays, checked against the layout; see ``join``."""
        blocks = self._blocks(index, raw)
        return unpack_stamp(blocks[0]), blocks[1:]

    def hear_part(self, index: int, raw: bytes) -> tuple[int, Blocks]:
        """``decode_part`` of a message that may be anything, behind ``peek``.

        Raises:
            LayoutError: as ``peek``, or the part has another layout (CommandError for commands).
        """
        known = self.layouts[index].cut(raw)
        if known is not None:
            return stamp_of(known[0]), known[1:]
        self.peek(index, raw)
        return self.decode_part(index, raw)

    def finite_blocks(self, index: int, raw: bytes) -> Blocks:
        """The bytes of the arrays of one part that can be used on its own; see ``join``.

        A part that is checked when it comes cannot take good ones of its stamp down with it.

        Raises:
            LayoutError: the part has another layout (CommandError for commands).
            NonFiniteError: a number is NaN or infinite.
        """
        _, *blocks = self._blocks(index, raw)
        if not all_finite(blocks):
            wrong = next(one for block in blocks for one in memoryview(block).cast("d") if not isfinite(one))
            raise NonFiniteError("not a finite number", key=self.layouts[index].topic, value=wrong)
        return blocks

    def join(self, stamp: int, parts: Sequence[Blocks]) -> V:
        """The value from what ``decode_part`` gave for each part."""
        raise NotImplementedError

    def _blocks(self, index: int, raw: bytes) -> tuple[bytes, ...]:
        """Stamp and arrays of a message, of this robot's own or by name."""
        layout = self.layouts[index]
        try:
            return layout.blocks(raw)
        except (LayoutError, CommandError):
            return layout.blocks(conformed(layout, self.topics[index].type, raw))


class StateCodec(PartsCodec[RobotState]):
    """RobotState to and from base/odom, joint_states and base/imu.

    The twist of base/odom is the one that counts; orientation and rate in base/imu are copies of the same measurement.
    """

    topics = topics_of("state")

    def __init__(self, joint_names: Sequence[str]) -> None:
        self.layouts = (
            standard.odometry(BASE_ODOM.name, standard.BASE_LINK),
            standard.joint_state(JOINT_STATES.name, joint_names, ("position", "velocity", "effort")),
            standard.imu(BASE_IMU.name),
        )

    def encode(self, value: RobotState) -> tuple[bytes, ...]:
        """The messages of a state, in the order of ``topics``."""
        odometry, joints, imu = self.layouts
        time, q, v = pack_stamp(value.stamp), value.q.tobytes(), value.v.tobytes()
        return (
            odometry.fill(time, q[:56], v[:48]),
            joints.fill(time, q[56:], v[48:], value.effort.tobytes()),
            imu.fill(time, q[24:56], v[24:48], value.base_acceleration.tobytes()),
        )

    def join(self, stamp: int, parts: Sequence[Blocks]) -> RobotState:
        """The state from what ``decode_part`` gave for each part."""
        (pose, twist), (position, velocity, effort), (_, _, acceleration) = parts
        blocks = pose + position, twist + velocity, effort, acceleration
        if all_finite(blocks):
            return value_of(RobotState, stamp, *map(np.frombuffer, blocks), None)
        return RobotState(stamp, *map(np.frombuffer, blocks))


class ReferenceCodec(PartsCodec[Reference]):
    """Reference to and from reference/base, reference/base_accel and reference/joints."""

    topics = topics_of("reference")

    def __init__(self, joint_names: Sequence[str]) -> None:
        self.layouts = (
            standard.odometry(REFERENCE_BASE.name, standard.BASE_LINK_DESIRED),
            standard.accel_stamped(REFERENCE_BASE_ACCEL.name),
            standard.joint_trajectory(REFERENCE_JOINTS.name, joint_names),
        )

    def encode(self, value: Reference) -> tuple[bytes, ...]:
        """The messages of a reference, in the order of ``topics``."""
        odometry, accel, joints = self.layouts
        time, q, v, a = pack_stamp(value.stamp), value.q.tobytes(), value.v.tobytes(), value.a.tobytes()
        return (
            odometry.fill(time, q[:56], v[:48]),
            accel.fill(time, a[:48]),
            joints.fill(time, q[56:], v[48:], a[48:]),
        )

    def join(self, stamp: int, parts: Sequence[Blocks]) -> Reference:
        """The reference from what ``decode_part`` gave for each part."""
        (pose, twist), (acceleration,), (positions, velocities, accelerations) = parts
        blocks = pose + positions, twist + velocities, acceleration + accelerations
        if all_finite(blocks):
            return value_of(Reference, stamp, *map(np.frombuffer, blocks))
        return Reference(stamp, *map(np.frombuffer, blocks))


class CommandCodec(PartsCodec[Command]):
    """Command to and from base/wrench_command and joint_command; what does not fit is a CommandError."""

    topics = topics_of("command")

    def __init__(self, joint_names: Sequence[str]) -> None:
        self.layouts = (
            standard.wrench_stamped(WRENCH_COMMAND.name, CommandError),
            standard.joint_state(JOINT_COMMAND.name, joint_names, ("effort",), CommandError),
        )

    def encode(self, value: Command) -> tuple[bytes, ...]:
        """The messages of a command, in the order of ``topics``."""
        wrench, joints = self.layouts
        time = pack_stamp(value.stamp)
        return wrench.fill(time, value.wrench.tobytes()), joints.fill(time, value.effort.tobytes())

    def join(self, stamp: int, parts: Sequence[Blocks]) -> Command:
        """The command from what ``decode_part`` gave for each part."""
        (wrench,), (effort,) = parts
        if all_finite((wrench, effort)):
            return value_of(Command, stamp, np.frombuffer(wrench), np.frombuffer(effort))
        return Command(stamp, np.frombuffer(wrench), np.frombuffer(effort))
