"""What commanded a run: the law of its experiment, or nodes of another project, of which the log has the names."""

from __future__ import annotations

import json
from collections.abc import Iterable
from contextlib import suppress

from space_robot_bringup.experiment.controller import EXTERNAL
from space_robot_bringup.logs.happened import Happened
from space_robot_msgs_py.events import PUBLISHERS
from space_robot_msgs_py.topics import topics_of

_COMMANDS = {topic.name: topic.publisher for topic in topics_of("command")}


def external_nodes(events: Iterable[Happened]) -> tuple[str, ...]:
    """Names of the nodes of other projects that published commands, each once, in order.

    Args:
        events: of a run, in order.
    """
    found: dict[str, None] = {}
    for event in events:
        topic = event.detail.get("topic", "") if event.name == PUBLISHERS else ""
        if topic not in _COMMANDS:
            continue
        with suppress(ValueError, TypeError):
            names = [str(name) for name in json.loads(event.detail.get("nodes", "[]"))]
            found |= dict.fromkeys(name for name in names if name.rpartition("/")[2] != _COMMANDS[topic])
    return tuple(found)


def law_said(law: str, events: Iterable[Happened]) -> str:
    """What a run is said to be under: its law, or that something else commanded.

    Args:
        law: of the experiment.
        events: of the run, in order.
    """
    nodes = external_nodes(events)
    if not nodes:
        return law
    said = f"{EXTERNAL} ({', '.join(nodes)})"
    return said if law == EXTERNAL else f"{said}, experiment of {law}"
