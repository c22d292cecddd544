"""A short run that stands at a state without an answer, and what a stranger may answer."""

from __future__ import annotations

import numpy as np

from space_robot_control.nodes.controller import ControllerNode
from space_robot_msgs_py.codec.codecs import CommandCodec
from space_robot_msgs_py.interfaces import Command
from space_robot_msgs_py.topics import JOINT_COMMAND, WRENCH_COMMAND
from tests.support.harness import RunningGraph

SHORT = "duration=5.0"
PERIOD, STEPS, AT = 250_000_000, 20, 9
EFFORT = 0.001


def controller_of(robot: RunningGraph) -> ControllerNode:
    node = robot.nodes["controller"]
    assert isinstance(node, ControllerNode)
    return node


def stand_unanswered(robot: RunningGraph) -> None:
    """Bring the run to a state that waits for its answer."""
    robot.simulator.pause(True)
    for tick in range(AT):
        robot.spin_until(lambda tick=tick: robot.await_answer() == tick, "an answer")
        if tick == AT - 1:
            controller_of(robot).trigger_deactivate()
        robot.simulator.step_once()
    robot.spin_until(lambda: robot.simulator.tick == AT, "the state")
    robot.settle()


def go_on(robot: RunningGraph) -> None:
    """Let the run go on to its end."""
    robot.simulator.pause(False)
    if not controller_of(robot).active:
        controller_of(robot).trigger_activate()
    robot.spin_until(lambda: robot.recorder.end_reason, "the end of the run")
    robot.spin_until(lambda: robot.recorder.complete, "the last tick")
    robot.settle()
    robot.recorder.finish("completed")


def foreign(robot: RunningGraph, stamp: int, effort: float = EFFORT) -> tuple[bytes, ...]:
    """A whole command of a stranger, which knows of no marks."""
    n = len(robot.composition.joint_names)
    return CommandCodec(robot.composition.joint_names).encode(Command(stamp, np.zeros(6), np.full(n, effort)))


def publish(robot: RunningGraph, parts: tuple[bytes, ...]) -> None:
    robot.publish(WRENCH_COMMAND, parts[0])
    robot.publish(JOINT_COMMAND, parts[1])
