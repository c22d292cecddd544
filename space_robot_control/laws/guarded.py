"""The call of a law: whatever it raises becomes one error that names the law, the tick and the cause."""

from __future__ import annotations

from space_robot_msgs_py.errors import ControlError, SpaceRobotError
from space_robot_msgs_py.interfaces import Controller, ControlOutput, Reference, RobotState


class LawError(ControlError):
    """A law raised what no law should; ``__cause__`` is what it raised."""


def guarded_update(controller: Controller, state: RobotState, reference: Reference, tick: int) -> ControlOutput:
    """The answer of a law to one state.

    Args:
        controller: the law.
        state: see ``Controller.update``.
        reference: likewise.
        tick: of the state, for the error.

    Raises:
        SpaceRobotError: the law cannot go on, by its own word.
        LawError: it raised anything else, ``SystemExit`` among it.
    """
    try:
        return controller.update(state, reference)
    except SpaceRobotError:
        raise
    except (Exception, SystemExit) as error:
        name = getattr(controller, "name", "") or type(controller).__qualname__
        raise LawError(f"{type(error).__name__}: {error}", key=f"law {name} at tick {tick}") from error
