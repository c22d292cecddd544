"""The wheel momentum of a state, which only some runs measure, to and from base/wheel_momentum."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from space_robot_msgs_py.codec import message_layouts as standard
from space_robot_msgs_py.codec.cdr import pack_stamp
from space_robot_msgs_py.codec.values import Blocks, PartsCodec
from space_robot_msgs_py.errors import LayoutError
from space_robot_msgs_py.interfaces import RobotState, Vector
from space_robot_msgs_py.topics import WHEEL_MOMENTUM

Measured = tuple[int, Vector]


class WheelMomentumCodec(PartsCodec[Measured]):
    """Stamp [ns] and momentum (3,) [N m s] to and from base/wheel_momentum."""

    topics = (WHEEL_MOMENTUM,)

    def __init__(self) -> None:
        self.layouts = (standard.vector_stamped(WHEEL_MOMENTUM.name),)

    def encode(self, value: Measured) -> tuple[bytes, ...]:
        """The one message of a reading."""
        stamp, momentum = value
        return (self.layouts[0].fill(pack_stamp(stamp), momentum.tobytes()),)

    def join(self, stamp: int, parts: Sequence[Blocks]) -> Measured:
        """The reading from what ``decode_part`` gave."""
        ((momentum,),) = parts
        return stamp, np.frombuffer(momentum)

    def of(self, state: RobotState) -> bytes | None:
        """The message of a state; None where its wheels are not measured."""
        return None if state.wheel_momentum is None else self.encode((state.stamp, state.wheel_momentum))[0]

    def read(self, raw: bytes) -> int:
        """The stamp [ns] of a message that can be used.

        Raises:
            LayoutError: it has another layout, or is far longer.
            NonFiniteError: a number is NaN or infinite.
        """
        stamp = self.peek(0, raw)
        self.finite_blocks(0, raw)
        return stamp

    def added(self, state: RobotState, raw: bytes | None) -> RobotState:
        """The state with what a message says of its wheels; None: they are not measured.

        Raises:
            LayoutError: the message has another layout, or is of another stamp.
            NonFiniteError: a number is NaN or infinite.
        """
        if raw is None:
            return state
        stamp, momentum = self.decode((raw,))
        if stamp != state.stamp:
            stamps = [state.stamp, stamp]
            raise LayoutError("parts of different stamps", key=WHEEL_MOMENTUM.name, value=stamps, accepted="one stamp")
        return replace(state, wheel_momentum=momentum)
