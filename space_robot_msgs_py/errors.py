"""One base error; every class is also the builtin a caller would expect, and carries key, value and accepted."""

from __future__ import annotations

from space_robot_msgs_py.escapes import visible

# A message is one line; what it quotes may be anything, also something of megabytes.
MAX_QUOTED = 2_000
MAX_PART = 4_000


class SpaceRobotError(Exception):
    """Base of every error this project raises on purpose; the message is one line fit for a terminal.

    Args:
        message: what is wrong, in one sentence.
        key: the dotted name of the offending input, e.g. ``controller.gains.bandwidth``.
        value: the offending value.
        accepted: what would be accepted instead.

    Attributes:
        problems: where several things are wrong: an error for each, this one among them.
    """

    problems: tuple[SpaceRobotError, ...] = ()

    def __init__(self, message: str, *, key: str = "", value: object = None, accepted: str = "") -> None:
        self.message, self.key, self.value, self.accepted = message, key, value, accepted
        parts = [f"{key}: {message}" if key else message]
        if value is not None:
            parts.append(f"got {quoted(value)}")
        if accepted:
            parts.append(f"accepted: {accepted}")
        super().__init__("; ".join(" ".join(shortened(visible(part), MAX_PART).split()) for part in parts))


def quoted(value: object) -> str:
    """A value for an error, whatever it is and however long."""
    try:
        return shortened(repr(value), MAX_QUOTED)
    except (ValueError, RecursionError):
        # Python prints no integer of more than 4,300 digits.
        return f"a {type(value).__name__} that is too long to print"


def shortened(text: str, most: int) -> str:
    """A text without its middle where it is too long."""
    return text if len(text) <= most else f"{text[: 2 * most // 3]}...{text[-most // 3 + 3 :]}"


class SpaceRobotWarning(UserWarning):
    """Something is allowed and probably not meant, such as a run outside the bounds of its law."""


class SpecError(SpaceRobotError, ValueError):
    """An experiment, robot or option says something that cannot be done."""


class CodeError(SpecError):
    """Data names code that the user of the program has not named."""


class InputFileError(SpaceRobotError, OSError):
    """A file is missing or cannot be read as what it should be."""


class NonFiniteError(SpaceRobotError, ValueError):
    """A NaN or an infinity stood at a boundary."""


class InertiaError(SpaceRobotError, ValueError):
    """A body's mass or inertia is physically impossible."""


class CommandError(SpaceRobotError, ValueError):
    """A command does not fit the robot or the tick: names, size, stamp."""


class LayoutError(SpaceRobotError, ValueError):
    """The bytes of a message do not have the layout its topic prescribes."""


class LogError(SpaceRobotError, OSError):
    """A log cannot be written or read."""


class ControlError(SpaceRobotError, ArithmeticError):
    """A control law met numbers it cannot go on with; the run ends with this reason."""


class IntegrationError(SpaceRobotError, ArithmeticError):
    """The plant could not be integrated to the requested accuracy."""


class SilenceError(SpaceRobotError, TimeoutError):
    """A node waited for a message longer than its deadline."""
