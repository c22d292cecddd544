"""What the plant does not take of a command although it fits the robot: too large, too sudden; published as events."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np

from space_robot_msgs_py.events import WARN, DiagnosticEvent
from space_robot_msgs_py.interfaces import Command, Vector
from space_robot_sim.spec import CommandCheck, MonitorSpec

CHANNELS = ("force_x", "force_y", "force_z", "torque_x", "torque_y", "torque_z")
# Names of the events.
MISSING, REFUSED, CLIPPED = "command missing", "command refused", "command clipped"


class CommandMonitor:
    """Checks commands before they act.

    Args:
        spec: what is checked; None: nothing, and nothing is published.
        limit: (6+n,) largest magnitude that acts per channel; infinite where there is none.
        joint_names: (n) names of the joints.
    """

    def __init__(self, spec: MonitorSpec | None, limit: Vector, joint_names: Sequence[str]) -> None:
        self._spec, self._limit, self._names = spec, limit, (*CHANNELS, *joint_names)
        self.reset()

    def reach(self) -> Vector:
        """(2, 6+n) largest magnitude, and largest change since the command before, that passes unchanged."""
        checks = (None, None) if self._spec is None else (self._spec.limit, self._spec.rate)
        return np.array(
            [np.full(self._limit.size, np.inf) if one is None else one.factor * self._limit for one in checks]
        )

    def reset(self) -> None:
        """Forget all commands and counts."""
        self._last: Vector | None = None
        self._periods = 0
        self._found: list[tuple[str, str, tuple[tuple[str, str], ...]]] = []
        self._counts: Counter[str] = Counter()

    def check(self, command: Command | None) -> Command | None:
        """The command as it may act; None: the hold acts. Call once per period."""
        if self._spec is None:
            return command
        self._periods += 1
        if command is None:
            self._tell(MISSING, "no usable command", ())
            return None
        u = self._within(command, "limit", command.u, self._spec.limit, np.zeros(self._limit.size), 1)
        if u is not None and self._last is not None:
            u = self._within(command, "rate", u, self._spec.rate, self._last, self._periods)
        if u is None:
            return None
        self._last, self._periods = u, 0
        # What nothing was cut of keeps its bits and its object.
        return command if u.tobytes() == command.u.tobytes() else Command(command.stamp, u[:6], u[6:])

    def events(self, stamp: int) -> tuple[DiagnosticEvent, ...]:
        """What was found in the period that ended at a stamp [ns]; given out once."""
        found, self._found = self._found, []
        events = []
        for name, message, values in found:
            self._counts[name] += 1
            count = ("count", str(self._counts[name]))
            events.append(DiagnosticEvent(stamp, WARN, name, message, "", (*values, count)))
        return tuple(events)

    def _within(
        self, command: Command, name: str, u: Vector, check: CommandCheck | None, centre: Vector, periods: int
    ) -> Vector | None:
        """A command within its distance of a centre; None where it is refused."""
        if check is None:
            return u
        reach = check.factor * periods * self._limit
        beyond = np.abs(u - centre) > reach
        if not beyond.any():
            return u
        worst = int(np.argmax(np.where(beyond, np.abs(u - centre) - reach, -np.inf)))
        values = (
            ("stamp", str(command.stamp)),
            ("channel", self._names[worst]),
            ("commanded", repr(float(u[worst]))),
            ("accepted", " to ".join(repr(float(centre[worst] + side * reach[worst])) for side in (-1.0, 1.0))),
        )
        refused = check.response == "refuse"
        self._tell(REFUSED if refused else CLIPPED, name, values)
        return None if refused else np.clip(u, centre - reach, centre + reach)

    def _tell(self, name: str, message: str, values: tuple[tuple[str, str], ...]) -> None:
        self._found.append((name, message, values))
