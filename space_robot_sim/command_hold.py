"""Which command acts in a period: the answer to its state, an older one, or the hold."""

from __future__ import annotations

from math import inf
from typing import Literal, NamedTuple

import numpy as np

from space_robot_msgs_py.errors import CommandError
from space_robot_msgs_py.interfaces import Command, Vector
from space_robot_sim.spec import Hold, HoldFor

NO_COMMAND = -1


class Acting(NamedTuple):
    """What acts in a period.

    Attributes:
        u: (6+n,) generalised force [N, N m].
        stamp: of the command it comes from [ns]; ``NO_COMMAND`` where nothing was commanded.
    """

    u: Vector
    stamp: int


class CommandHold:
    """Keeps commands until they act.

    Args:
        joints: number of joints.
        delay_periods: 1: the command that answers state k acts from state k+1 on, and nothing does before.
        hold: what acts in place of a missing command: nothing, the last one, or the last one for some periods.

    Attributes:
        delay: periods by which a command acts late.
        held: the last command that came.
    """

    def __init__(self, joints: int, *, delay_periods: Literal[0, 1], hold: Hold) -> None:
        self._joints, self.delay = joints, delay_periods
        self._patience: float = hold.last_for if isinstance(hold, HoldFor) else inf if hold == "last" else 0
        self._brakes = isinstance(hold, HoldFor) and hold.brakes
        self._nothing = Acting(np.zeros(6 + joints), NO_COMMAND)
        self.reset()

    def reset(self) -> Acting:
        """Forget all commands; what acts now is nothing."""
        self.held = self._waiting = self._nothing
        self._missing = 0
        return self._nothing

    @property
    def brakes(self) -> bool:
        """The brakes close because there was no usable command for too long."""
        return self._brakes and self._missing > self._patience

    def take(self, command: Command | None) -> Acting:
        """What acts in the period that begins with this command (None: the hold).

        Raises:
            CommandError: the command is not for this many joints.
        """
        acting = self._accept(command)
        if self.delay:
            acting, self._waiting = self._waiting, acting
        return acting

    def _accept(self, command: Command | None) -> Acting:
        if command is None:
            self._missing += 1
            return self.held if self._missing <= self._patience else self._nothing
        if command.effort.size != self._joints:
            key, size = "command.effort", command.effort.size
            raise CommandError("wrong size", key=key, value=size, accepted=f"{self._joints}")
        self._missing = 0
        self.held = Acting(command.u, command.stamp)
        return self.held
