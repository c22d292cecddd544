"""Which command acts in a period, where commands act later than in the period of their state."""

from __future__ import annotations

from typing import Generic, TypeVar

import numpy as np

from space_robot_msgs_py.interfaces import Command

# Stamp of the zero that acts before the first command does.
NO_COMMAND = -1
Owner = TypeVar("Owner")


class CommandDelay(Generic[Owner]):
    """The commands that are sent and do not act yet, as far as the flight software knows of them.

    What an estimator pairs with the motion over a period is the command that acted over it, and not the one that was
    computed at its beginning.

    Args:
        periods: between the state a command answers and the period it acts in; see ``Robot.command_delay``.
        none: owner of the rest before the first command acts.
    """

    def __init__(self, periods: int, none: Owner) -> None:
        self._periods, self._none = periods, none
        self.reset()

    def reset(self) -> None:
        """Forget all commands; nothing acts until the next one does."""
        self._waiting: list[tuple[Command, Owner]] = []

    def acting(self, command: Command, owner: Owner) -> tuple[Command, Owner]:
        """The command that acts in the period in which this one is computed, and who computed it."""
        if not self._periods:
            return command, owner
        self._waiting.append((command, owner))
        if len(self._waiting) <= self._periods:
            return Command(NO_COMMAND, np.zeros(6), np.zeros(command.effort.size)), self._none
        return self._waiting.pop(0)
