"""How the events of a log look: a table for people, a list for programs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from space_robot_bringup.logs.happened import Happened
from space_robot_cli.terminal import markup

STYLES = {"info": "", "low": "", "medium": "yellow", "high": "red"}


def print_events(console: Console, events: Sequence[Happened], left_out: int) -> None:
    """Print one line per event."""
    table = Table(box=SIMPLE_HEAD)
    table.add_column("time [s]".replace("[", r"\["), justify="right", no_wrap=True)
    for heading in ("source", "severity", "event"):
        table.add_column(heading, no_wrap=True)
    table.add_column("detail")
    for event in events:
        cells = (
            f"{event.time:.10g}",
            event.source,
            event.severity,
            f"{event.name} {event.message}".strip(),
            event.said,
        )
        table.add_row(*map(markup, cells), style=STYLES[event.severity])
    if events:
        console.print(table)
    else:
        console.print("no events")
    if left_out:
        console.print(f"and {left_out} more after these", markup=False)


def event_dict(event: Happened) -> dict[str, Any]:
    """One as plain data."""
    return {
        "stamp": event.stamp,
        "time": event.time,
        "source": event.source,
        "severity": event.severity,
        "name": event.name,
        "message": event.message,
        "detail": dict(event.detail),
    }
