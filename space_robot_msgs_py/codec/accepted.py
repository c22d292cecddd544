"""What a simulator says of each command it gets, as blocks of a std_msgs/Float64MultiArray."""

from __future__ import annotations

from typing import NamedTuple

import numpy.typing as npt

from space_robot_msgs_py.codec.telemetry import TelemetryCodec
from space_robot_msgs_py.errors import CommandError
from space_robot_msgs_py.interfaces import Command, Telemetry
from space_robot_msgs_py.topics import ACCEPTED_COMMAND

# Of a run with two controllers, by the names of their nodes: the one that begins, and the one that stands by.
CONTROLLERS = ("controller", "standby")
_TOO_LATE = "too_late"
_ACTING = "acting:"


class Accepted(NamedTuple):
    """What a simulator did with the command for one stamp.

    Attributes:
        stamp: of the state that it answers [ns].
        command: it; None: there was none when its period was over, or none that could be used.
        too_late: it can act no more, but its state was answered.
        acting: of a run with two controllers: the name of the one that answers the state after this.
        answered: of such a run: to how many states there was an answer so far.
    """

    stamp: int
    command: Command | None
    too_late: bool = False
    acting: str = ""
    answered: int = 0


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
        if value.acting:
            blocks[f"{_ACTING}{value.acting}"] = (float(value.answered),)
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
        acting, answered = _turn(telemetry)
        if not wrench.size:
            return Accepted(telemetry.stamp, None, too_late, acting, answered)
        if wrench.size != 6:
            raise CommandError("wrong size", key=f"{ACCEPTED_COMMAND.name}.wrench", value=wrench.size, accepted="6")
        return Accepted(telemetry.stamp, Command(telemetry.stamp, wrench, effort), too_late, acting, answered)


def _turn(telemetry: Telemetry) -> tuple[str, int]:
    """Who acts, and how many states were answered; nothing where there is one controller."""
    for label in telemetry.labels:
        if label.startswith(_ACTING):
            count = telemetry[label]
            if count.size != 1:
                raise CommandError("wrong size", key=f"{ACCEPTED_COMMAND.name}.{label}", value=count.size, accepted="1")
            return label.removeprefix(_ACTING), int(count[0])
    return "", 0
