"""What a simulator says of each command it gets, as blocks of a std_msgs/Float64MultiArray."""

from __future__ import annotations

from typing import NamedTuple

import numpy.typing as npt

from space_robot_msgs_py.codec.telemetry import TelemetryCodec
from space_robot_msgs_py.errors import CommandError
from space_robot_msgs_py.interfaces import Command, Telemetry
from space_robot_msgs_py.topics import ACCEPTED_COMMAND

_TOO_LATE = "too_late"


class Accepted(NamedTuple):
    """What a simulator did with the command for one stamp.

    Attributes:
        stamp: of the state that it answers [ns].
        command: it; None: there was none when its period was over, or none that could be used.
        too_late: it can act no more, but its state was answered.
    """

    stamp: int
    command: Command | None
    too_late: bool = False


class AcceptedCodec:
    """``accepted_command`` to and from bytes."""

    def __init__(self) -> None:
        self._codec = TelemetryCodec(ACCEPTED_COMMAND)

    def encode(self, value: Accepted) -> bytes:
        """The message."""
        command = value.command
        blocks: dict[str, npt.ArrayLike] = {"wrench": (), "effort": ()}
        if command is not None:
            blocks = {"wrench": command.wrench, "effort": command.effort}
        if value.too_late:
            blocks[_TOO_LATE] = (1.0,)
        return self._codec.encode(Telemetry.of(value.stamp, blocks))[0]

    def decode(self, raw: bytes) -> Accepted:
        """Inverse of ``encode``.

        Raises:
            LayoutError: the bytes are no such message.
            NonFiniteError: a number is NaN or infinite.
            CommandError: the wrench is none.
        """
        telemetry = self._codec.decode((raw,))
        wrench, effort, too_late = telemetry["wrench"], telemetry["effort"], _TOO_LATE in telemetry.labels
        if not wrench.size:
            return Accepted(telemetry.stamp, None, too_late)
        if wrench.size != 6:
            raise CommandError("wrong size", key=f"{ACCEPTED_COMMAND.name}.wrench", value=wrench.size, accepted="6")
        return Accepted(telemetry.stamp, Command(telemetry.stamp, wrench, effort), too_late)
