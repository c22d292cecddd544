"""Runs that another node commands: without the controller of the project, to their end, and what acted."""

from __future__ import annotations

from pathlib import Path

from space_robot_msgs_py.codec.codecs import CommandCodec
from space_robot_msgs_py.log.reader import LogReader
from tests.support.harness import RunningGraph

ALONE = ("recorder", "guidance", "simulator")


def efforts(place: Path) -> list[float]:
    """First effort of every tick that has a command."""
    log = LogReader(place)
    codec = CommandCodec(log.header.joint_names)
    rows = [[parts.get(topic.name) for topic in codec.topics] for _, parts in log.stamps()]
    return [float(codec.decode([raw for raw in row if raw]).effort[0]) for row in rows if all(row)]


def end(robot: RunningGraph) -> None:
    """To the end of the run and of the log."""
    robot.spin_until(lambda: robot.recorder.end_reason, "the end of the run")
    robot.settle()
    robot.recorder.finish(str(robot.recorder.end_reason))
