"""How a node says on /diagnostics how it is: everything that depends on the wall clock is there and nowhere else."""

from __future__ import annotations

from collections.abc import Mapping

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.node import Node

from space_robot_msgs_py.interfaces import NANOSECONDS
from space_robot_msgs_py.nodes.fill import fill
from space_robot_msgs_py.topics import DIAGNOSTICS


class Diagnostics:
    """Publishes the statuses of one node.

    Args:
        node: in whose name.
        hardware: what the statuses are about.
    """

    def __init__(self, node: Node, hardware: str) -> None:
        self._name, self._hardware = node.get_name(), hardware
        self._publisher = node.create_publisher(DiagnosticArray, DIAGNOSTICS.name, 10)

    def status(self, what: str, warnings: list[str], well: str, numbers: Mapping[str, float | str]) -> DiagnosticStatus:
        """One status: OK with ``well``, or WARN with the warnings.

        Args:
            what: part of the node.
            warnings: what is not as it should be.
            well: what to say where nothing is.
            numbers: values by key; the unit is part of the key.
        """
        return fill(
            DiagnosticStatus(),
            name=f"{self._name}: {what}",
            hardware_id=self._hardware,
            level=DiagnosticStatus.WARN if warnings else DiagnosticStatus.OK,
            message="; ".join(warnings) or well,
            values=[fill(KeyValue(), key=k, value=v if isinstance(v, str) else f"{v:g}") for k, v in numbers.items()],
        )

    def publish(self, stamp: int, statuses: list[DiagnosticStatus]) -> None:
        """Publish statuses at a stamp [ns] of the run."""
        message = fill(DiagnosticArray(), status=statuses)
        fill(message.header.stamp, sec=stamp // NANOSECONDS, nanosec=stamp % NANOSECONDS)
        self._publisher.publish(message)
