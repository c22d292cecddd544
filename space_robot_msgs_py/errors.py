"""One base error; every class is also the builtin a caller would expect, and carries key, value and accepted."""

from __future__ import annotations


class SpaceRobotError(Exception):
    """Base of every error this project raises on purpose; the message is one line fit for a terminal.

    Args:
        message: what is wrong, in one sentence.
        key: the dotted name of the offending input, e.g. ``controller.gains.bandwidth``.
        value: the offending value.
        accepted: what would be accepted instead.
    """

    def __init__(self, message: str, *, key: str = "", value: object = None, accepted: str = "") -> None:
        self.message, self.key, self.value, self.accepted = message, key, value, accepted
        parts = [f"{key}: {message}" if key else message]
        if value is not None:
            parts.append(f"got {value!r}")
        if accepted:
            parts.append(f"accepted: {accepted}")
        super().__init__("; ".join(" ".join(part.split()) for part in parts))


class SpaceRobotWarning(UserWarning):
    """Something is allowed and probably not meant, such as a run outside the bounds of its law."""


class SpecError(SpaceRobotError, ValueError):
    """An experiment, robot or option says something that cannot be done."""


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
