"""``--chaos``: processes of a paced run are killed, stopped and started again by a seeded plan."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from random import Random
from typing import Literal

from space_robot_bringup.modes.heartbeats import SILENT_SECONDS
from space_robot_msgs_py.codec.accepted import CONTROLLERS

Action = Literal["kill", "stop", "restart"]
ACTIONS: tuple[Action, ...] = ("kill", "stop", "restart")
BLOWS = 3


@dataclass(frozen=True, slots=True)
class Blow:
    """What is done to a process, and when.

    Attributes:
        tick: when that one is in the log.
        role: of the process.
        action: ``kill`` (SIGKILL), ``stop`` (SIGSTOP, then SIGCONT) or ``restart`` (SIGKILL, and a new process).
        seconds: of a stop, of the steady clock [s].
    """

    tick: int
    role: str
    action: Action
    seconds: float = 0.0

    @property
    def line(self) -> str:
        """For people."""
        how = f" for {self.seconds:.1f} s" if self.action == "stop" else ""
        return f"chaos: {self.action} {self.role}{how} at tick {self.tick}"


def plan(seed: int, steps: int, roles: Sequence[str]) -> tuple[Blow, ...]:
    """What is done in a run, the same for the same seed, in the order of time.

    Where there are two controllers they are what is killed and started again; any process may be stopped, half of the
    times for longer than a silence that is put up with.

    Args:
        seed: of the plan.
        steps: of the run.
        roles: of its processes.
    """
    random, pair = Random(f"chaos {seed}"), [role for role in roles if role in CONTROLLERS]
    blows = []
    for tick in sorted(random.randint(1, max(1, steps - 1)) for _ in range(BLOWS)):
        action = random.choice(ACTIONS)
        if action == "restart" and len(pair) < len(CONTROLLERS):
            action = "stop"
        killed = action != "stop" and len(pair) == len(CONTROLLERS)
        role = random.choice(pair if killed else list(roles))
        seconds = random.uniform(0.1, 2.0 * SILENT_SECONDS)
        blows.append(Blow(tick, role, action, seconds if action == "stop" else 0.0))
    return tuple(blows)
