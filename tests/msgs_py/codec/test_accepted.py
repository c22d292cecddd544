"""What a simulator says of a command, to and from bytes."""

from __future__ import annotations

import pytest

from space_robot_msgs_py.codec.codecs import Accepted, AcceptedCodec, TelemetryCodec
from space_robot_msgs_py.errors import CommandError, LayoutError
from space_robot_msgs_py.events import ControllerEvent
from space_robot_msgs_py.interfaces import Command, Telemetry
from space_robot_msgs_py.topics import ACCEPTED_COMMAND

COMMAND = Command(500, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0], [7.0, 8.0])
EVENTS = (
    ControllerEvent(500, "parameters", {"values": {"gains.kappa": 0.5, "gains.lambda": [1.0, 2.0]}}),
    ControllerEvent(500, "reset", {}),
    ControllerEvent(500, "reset", {}),
)
NOTHING = {"wrench": (), "effort": ()}


@pytest.mark.parametrize(
    "said",
    [
        Accepted(500, COMMAND),
        Accepted(500, None),
        Accepted(500, COMMAND, too_late=True),
        Accepted(500, None, acting="standby", answered=3, since=1000),
        Accepted(500, COMMAND, acting="controller", answered=4, since=0, events=EVENTS),
    ],
)
def test_all_that_is_said_comes_back(said: Accepted) -> None:
    """Command, turn and events; events to the line."""
    found = AcceptedCodec().decode(AcceptedCodec().encode(said))
    assert found._replace(command=None, events=()) == said._replace(command=None, events=())
    assert [one.line for one in found.events] == [one.line for one in said.events]
    for mine, other in zip([found.command], [said.command], strict=True):
        assert (mine is None) == (other is None)
        assert mine is None or other is None or mine.u.tobytes() == other.u.tobytes()


def test_one_controller_says_nothing_of_turns() -> None:
    """The message of such a run has two blocks beside the stamp, and no others."""
    raw = AcceptedCodec().encode(Accepted(500, COMMAND))
    assert TelemetryCodec(ACCEPTED_COMMAND).decode((raw,)).labels == ("wrench", "effort")


@pytest.mark.parametrize(
    ("blocks", "error", "said"),
    [
        ({"acting:controller": (1.0,)}, CommandError, "acting:controller: wrong size"),
        ({"event0:no event": ()}, LayoutError, "not an event"),
        ({"wrench": (1.0, 2.0)}, CommandError, "wrench: wrong size"),
    ],
)
def test_what_is_none_is_refused(blocks: dict[str, tuple[float, ...]], error: type[Exception], said: str) -> None:
    """With what is wrong."""
    raw = TelemetryCodec(ACCEPTED_COMMAND).encode(Telemetry.of(500, NOTHING | blocks))[0]
    with pytest.raises(error, match=said):
        AcceptedCodec().decode(raw)
