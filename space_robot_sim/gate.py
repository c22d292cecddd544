"""The check of every command before it reaches the plant."""

from __future__ import annotations

from space_robot_msgs_py.errors import CommandError
from space_robot_msgs_py.interfaces import Command


class CommandGate:
    """Lets a command through that fits the robot and answers the present state, and counts the others.

    Args:
        n: number of joints.

    Attributes:
        counters: ``accepted``, ``wrong_size``, ``stale`` and ``future`` commands so far.
    """

    def __init__(self, n: int) -> None:
        self._n = n
        self.counters = {"accepted": 0, "wrong_size": 0, "stale": 0, "future": 0}

    def check(self, command: Command, expected_stamp: int) -> Command:
        """Return the command if it may act.

        Args:
            command: what came.
            expected_stamp: stamp of the state that waits for its answer [ns].

        Raises:
            CommandError: wrong number of efforts, or the answer to an earlier or a later state.
        """
        if command.effort.size != self._n:
            self._refuse("wrong_size", "wrong size", "command.effort", command.effort.size, f"{self._n} efforts")
        if command.stamp != expected_stamp:
            stale = command.stamp < expected_stamp
            kind, message = ("stale", "answers an earlier state") if stale else ("future", "answers a state to come")
            self._refuse(kind, message, "command.stamp", command.stamp, f"{expected_stamp} ns")
        self.counters["accepted"] += 1
        return command

    def _refuse(self, counter: str, message: str, key: str, value: int, accepted: str) -> None:
        self.counters[counter] += 1
        raise CommandError(message, key=key, value=value, accepted=accepted)
