"""One row of the topic table."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Kind = Literal[
    "state",
    "reference",
    "command",
    "accepted_command",
    "controller_telemetry",
    "controller_event",
    "supervision_event",
    "supervision",
    "housekeeping",
    "plant_telemetry",
    "plant_event",
    "description",
    "event",
    "set_point",
    "tool",
]


# Rows are compared and hashed by identity: there is one of each, and every message looks its row up.
@dataclass(frozen=True, slots=True, eq=False)
class Topic:
    """One row of the table.

    Attributes:
        name: relative names live in the run's namespace and can be remapped; absolute ones are ROS-wide.
        type: ROS type, ``package/msg/Name``.
        kind: the value it carries a part of; all topics of a kind share a stamp.
        publisher: the node that publishes it.
        latched: one message, kept for late joiners.
        sporadic: not every stamp has a message.
        recorded: it is written to the log.
        deterministic: equal runs give equal bytes.
        derived: in the log it follows from other messages of its stamp; it is derived when the log is written.
        optional: it is there only in runs that ask for it: a run without it has no channel in its log.
        meaning: for people.
    """

    name: str
    type: str
    kind: Kind
    publisher: str
    meaning: str
    latched: bool = False
    sporadic: bool = False
    recorded: bool = True
    deterministic: bool = True
    derived: bool = False
    optional: bool = False
