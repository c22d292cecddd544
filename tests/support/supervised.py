"""A supervisor of `mini` and what it says to runs of rates."""

from __future__ import annotations

from typing import Any

import numpy as np

from space_robot_description.actuation import command_limit
from space_robot_description.load import load_robot
from space_robot_description.validation import validate
from space_robot_msgs_py.interfaces import Reference, RobotState, Supervision
from space_robot_supervisor.supervisor import Supervisor
from space_robot_supervisor.table import SupervisionTable
from space_robot_supervisor.values import Snapshot

MINI = load_robot("mini")
MODES = {"NOMINAL": {}, "SAFE": {"law": "damped_hold", "reference": "here"}}
FAST = {"name": "fast", "value": "base.rate", "above": 1.0, "to": "SAFE", "in": ["NOMINAL"]}


def table(*monitors: dict[str, Any], **keys: Any) -> SupervisionTable:
    """A checked table."""
    found = validate(SupervisionTable, {"modes": MODES, "monitors": list(monitors)} | keys, "supervision.")
    found.check("supervision")
    return found


def supervisor(*monitors: dict[str, Any], **keys: Any) -> Supervisor:
    """A supervisor of `mini`."""
    return Supervisor(table(*monitors, **keys), MINI, ("error", "gain"), command_limit(MINI))


def snapshot(tick: int, rate: float = 0.0, **keys: Any) -> Snapshot:
    """A state that turns at this rate about z, and a reference that is somewhere else."""
    q = np.array([0, 0, 0, 0, 0, 0, 1.0, *MINI.home])
    v = np.array([0, 0, 0, 0, 0, rate, 0, 0, 0, 0])
    along_x, along_y = np.eye(11)[:2] * tick
    state = RobotState(tick, q + along_x, v, np.zeros(4), np.zeros(3))
    reference = Reference(tick, q - along_y, 0.1 + v, v)
    return Snapshot(state, reference, **keys)


def watched(one: Supervisor, rates: list[float]) -> list[Supervision]:
    """What it says to a run of rates."""
    return [one.update(snapshot(tick, rate)) for tick, rate in enumerate(rates)]


def reported(found: list[Supervision], name: str) -> list[tuple[int, str]]:
    """(tick, message) of the events of that name."""
    return [(tick, event.message) for tick, one in enumerate(found) for event in one.events if event.name == name]
