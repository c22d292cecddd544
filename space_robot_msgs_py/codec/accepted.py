"""What a simulator says of each command it gets, as blocks of a std_msgs/Float64MultiArray."""

from __future__ import annotations

import re
from typing import NamedTuple

import numpy.typing as npt

from space_robot_msgs_py.codec.telemetry import TelemetryCodec
from space_robot_msgs_py.errors import CommandError
from space_robot_msgs_py.events import ControllerEvent
from space_robot_msgs_py.interfaces import Command, Telemetry
from space_robot_msgs_py.topics import ACCEPTED_COMMAND

# Of a run with two controllers, by the names of their nodes: the one that begins, and the one that stands by.
CONTROLLERS = ("controller", "standby")
_TOO_LATE = "too_late"
_ACTING = "acting:"
# A block without numbers, whose label ends with the line of an event; "event0:..." is the first one.
_EVENT = re.compile(r"event\d+:(?P<line>.*)", re.DOTALL)


class Accepted(NamedTuple):
    """What a simulator did with the command for one stamp.

    Attributes:
        stamp: of the state that it answers [ns].
        command: it; None: there was none when its period was over, or none that could be used.
        too_late: it can act no more, but its state was answered; of two controllers, with no command: it is refused.
        acting: of a run with two controllers: the name of the one that answers the state after this.
        answered: of such a run: to how many states there was an answer so far.
        since: of such a run: stamp of the first state of its turn [ns].
        events: of such a run: what the controller said of this command, see ``ControllerEvent``.
    """

    stamp: int
    command: Command | None
    too_late: bool = False
    acting: str = ""
    answered: int = 0
    since: int = 0
    events: tuple[ControllerEvent, ...] = ()


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
            blocks[f"{_ACTING}{value.acting}"] = (float(value.answered), float(value.since))
        blocks |= {f"event{index}:{event.line}": () for index, event in enumerate(value.events)}
        return self._codec.encode(Telemetry.of(value.stamp, blocks))[0]

    def decode(self, raw: bytes) -> Accepted:
        """Inverse of ``encode``.

        Raises:
            LayoutError: the bytes are no such message, or an event is none.
            NonFiniteError: a number is NaN or infinite.
            CommandError: the wrench is none.
        """
        telemetry = self._codec.decode((raw,))
        wrench, effort = telemetry["wrench"], telemetry["effort"]
        if wrench.size not in (0, 6):
            raise CommandError("wrong size", key=f"{ACCEPTED_COMMAND.name}.wrench", value=wrench.size, accepted="6")
        command = Command(telemetry.stamp, wrench, effort) if wrench.size else None
        events = [ControllerEvent.of(found["line"]) for one in telemetry.labels if (found := _EVENT.fullmatch(one))]
        return Accepted(telemetry.stamp, command, _TOO_LATE in telemetry.labels, *_turn(telemetry), tuple(events))


def _turn(telemetry: Telemetry) -> tuple[str, int, int]:
    """Who acts, how many states were answered, and since when it acts; nothing where there is one controller."""
    for label in telemetry.labels:
        if label.startswith(_ACTING):
            numbers = telemetry[label]
            if numbers.size != 2:
                key = f"{ACCEPTED_COMMAND.name}.{label}"
                raise CommandError("wrong size", key=key, value=numbers.size, accepted="2")
            return label.removeprefix(_ACTING), int(numbers[0]), int(numbers[1])
    return "", 0, 0
