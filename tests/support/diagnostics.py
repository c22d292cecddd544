"""What a node that is none of the run hears on /diagnostics."""

from __future__ import annotations

from typing import Any

from diagnostic_msgs.msg import DiagnosticArray

from tests.support.harness import RunningGraph


def heard(robot: RunningGraph) -> dict[str, Any]:
    """Newest status by name, as it comes in."""
    newest: dict[str, Any] = {}

    def take(message: DiagnosticArray) -> None:
        newest.update({status.name: status for status in message.status})

    robot.stranger.create_subscription(DiagnosticArray, "/diagnostics", take, 10)
    return newest


def numbers(status: Any) -> dict[str, str]:
    """The values of a status."""
    return {value.key: value.value for value in status.values}
