"""One message that should not be there is refused, counted and logged; the run and its log are as without it."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("rclpy")
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.run import run_experiment
from space_robot_control.nodes.guidance import GuidanceNode
from space_robot_msgs_py.codec.cdr import ENCAPSULATION
from space_robot_msgs_py.codec.codecs import (
    CommandCodec,
    ReferenceCodec,
    StateCodec,
    WheelMomentumCodec,
    encode_clock,
    encode_string,
)
from space_robot_msgs_py.interfaces import Command, Reference, RobotState
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.topics import (
    ACCEPTED_COMMAND,
    BASE_ODOM,
    CONTROLLER_TELEMETRY,
    JOINT_COMMAND,
    JOINT_STATES,
    PLANT_TELEMETRY,
    RECORDER_CREDIT,
    REFERENCE_BASE,
    ROBOT_DESCRIPTION,
    RUN_BEGIN,
    RUN_END,
    WHEEL_MOMENTUM,
    WRENCH_COMMAND,
    Topic,
)
from tests.support.harness import RunningGraph, running_graph
from tests.support.replays import but_for_publishers
from tests.support.unanswered import AT, PERIOD, SHORT, STEPS, go_on, stand_unanswered

pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]
# With all that a state can have.
WHOLE = (SHORT, "plant.sensors.wheel_momentum={}")
JOINTS = 4
GARBAGE = ENCAPSULATION + b"\xff" * 4


def state(tick: float, poison: float = 0.1) -> tuple[bytes, ...]:
    """The messages of a state that is none of this run."""
    q = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, *[0.1] * JOINTS])
    value = RobotState(round(tick * PERIOD), q, np.full(6 + JOINTS, 0.125), np.zeros(JOINTS), np.zeros(3))
    parts = StateCodec(joint_names()).encode(value)
    return tuple(part.replace(np.float64(0.125).tobytes(), np.float64(poison).tobytes()) for part in parts)


def wheels(tick: float, z: float = 0.125) -> bytes:
    """A reading of wheels that are not this robot's."""
    return WheelMomentumCodec().encode((round(tick * PERIOD), np.array([0.0, 0.0, z])))[0]


def reference(tick: float) -> bytes:
    """The base part of a reference that guidance never gave."""
    q = np.array([9.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, *[0.1] * JOINTS])
    value = Reference(round(tick * PERIOD), q, np.zeros(6 + JOINTS), np.zeros(6 + JOINTS))
    return ReferenceCodec(joint_names()).encode(value)[0]


def command(tick: float, effort: float = 0.25, names: tuple[str, ...] | None = None) -> tuple[bytes, ...]:
    """The messages of a command of a stranger."""
    names = names or joint_names()
    value = Command(round(tick * PERIOD), np.zeros(6), np.full(len(names), 0.25))
    wrench, joints = CommandCodec(names).encode(value)
    return wrench, joints.replace(np.float64(0.25).tobytes(), np.float64(effort).tobytes())


def joint_names() -> tuple[str, ...]:
    return tuple(f"joint{k + 1}" for k in range(JOINTS))


def wild(raw: bytes) -> bytes:
    """The same message with a stamp that is no time."""
    return raw[:8] + b"\xff\xff\xff\xff" + raw[12:]


def message(**fields: object) -> bytes:
    return encode_string(json.dumps(fields))


STRAYS: dict[str, tuple[Topic, Callable[[], bytes]]] = {
    "an older state": (BASE_ODOM, lambda: state(0)[0]),
    "another state of this tick": (JOINT_STATES, lambda: state(AT)[1]),
    "a state of the tick to come": (JOINT_STATES, lambda: state(AT + 1)[1]),
    "a state far ahead": (BASE_ODOM, lambda: state(STEPS - 1)[0]),
    "a state beyond the end": (BASE_ODOM, lambda: state(1e6)[0]),
    "a state between two ticks": (BASE_ODOM, lambda: state(AT + 0.5)[0]),
    "a wild stamp": (BASE_ODOM, lambda: wild(state(AT)[0])),
    "the state of the tick to come": (BASE_ODOM, lambda: state(AT + 1)[0]),
    "a state that is not a number": (BASE_ODOM, lambda: state(AT + 1, np.nan)[0]),
    "a state that is none": (BASE_ODOM, lambda: GARBAGE),
    "an older reading of wheels": (WHEEL_MOMENTUM, lambda: wheels(3)),
    "another reading of wheels": (WHEEL_MOMENTUM, lambda: wheels(AT)),
    "the reading of the tick to come": (WHEEL_MOMENTUM, lambda: wheels(AT + 1)),
    "a reading that is not a number": (WHEEL_MOMENTUM, lambda: wheels(AT + 1, np.nan)),
    "a reading that is none": (WHEEL_MOMENTUM, lambda: GARBAGE),
    "another reference of this tick": (REFERENCE_BASE, lambda: reference(AT)),
    "an older reference": (REFERENCE_BASE, lambda: reference(0)),
    "a reference with a wild stamp": (REFERENCE_BASE, lambda: wild(reference(AT))),
    "8 bytes of credit": (RECORDER_CREDIT, lambda: GARBAGE),
    "a credit without end": (RECORDER_CREDIT, lambda: encode_clock(10**18)),
    "a credit between two ticks": (RECORDER_CREDIT, lambda: encode_clock(AT * PERIOD + 17)),
    "an end that is only text": (RUN_END, lambda: encode_string("completed")),
    "an end of another run": (RUN_END, lambda: message(run="1234", node="/stranger", reason="completed")),
    "an end of no run": (RUN_END, lambda: message(run="", node="/stranger", reason="completed")),
    "an end that is none": (RUN_END, lambda: GARBAGE),
    "a begin of another run": (RUN_BEGIN, lambda: message(run="1234", number=3)),
    "a begin that is none": (RUN_BEGIN, lambda: GARBAGE),
    "a description that is none": (ROBOT_DESCRIPTION, lambda: GARBAGE),
    "telemetry that is none": (PLANT_TELEMETRY, lambda: GARBAGE),
    "telemetry of a law that is none": (CONTROLLER_TELEMETRY, lambda: GARBAGE),
    "an accepted command": (ACCEPTED_COMMAND, lambda: GARBAGE),
    "an older command": (JOINT_COMMAND, lambda: command(3)[1]),
    "a command that comes too early": (JOINT_COMMAND, lambda: command(AT + 1)[1]),
    "a command with a wild stamp": (WRENCH_COMMAND, lambda: wild(command(AT)[0])),
    "a command that is not a number": (JOINT_COMMAND, lambda: command(AT, np.nan)[1]),
    "a command of another robot": (JOINT_COMMAND, lambda: command(AT, names=("a", "b"))[1]),
}
# What is not refused, because it does no harm: it is replaced by what comes, was heard before, or is heard by none.
HARMLESS = {
    *("a state of the tick to come", "the state of the tick to come", "a state far ahead"),
    *("the reading of the tick to come", "an older reference", "an accepted command", "a description that is none"),
}
TOPICS = sorted({topic.name for topic, _ in STRAYS.values()})


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> list[tuple[str, int, bytes]]:
    """The messages of the run without strays."""
    place = tmp_path_factory.mktemp("truth") / "run"
    run_experiment(load_experiment("liu2023/fig08", WHOLE), place, mode="headless")
    return list(LogReader(place).messages())


def refused(robot: RunningGraph) -> int:
    """How many messages were refused."""
    nodes = robot.nodes.values()
    return sum(sum(node.refusals.values()) for node in nodes) + sum(robot.simulator.commands.counts.values())


@pytest.mark.parametrize("name", TOPICS)
def test_a_stray_message_is_refused_and_changes_nothing(
    name: str, tmp_path: Path, undisturbed: list[tuple[str, int, bytes]]
) -> None:
    """The run completes in one log with the bits of an undisturbed one; strays are counted where they do not fit."""
    with running_graph(tmp_path / "run", *WHOLE) as robot:
        stand_unanswered(robot)
        for stray, (topic, make) in STRAYS.items():
            if topic.name == name:
                before = refused(robot)
                robot.publish(topic, make())
                robot.settle()
                assert robot.simulator.tick == AT, stray
                assert (refused(robot) > before) is (stray not in HARMLESS), stray
                assert [node.end_reason for node in robot.nodes.values()] == [None] * 4, stray
        go_on(robot)
        assert [node.end_reason for node in robot.nodes.values()] == ["completed"] * 4
    assert [path.name for path in tmp_path.iterdir()] == ["run"]
    assert but_for_publishers(tmp_path / "run") == undisturbed


def test_a_reference_that_is_said_again_is_no_news(tmp_path: Path, undisturbed: list[tuple[str, int, bytes]]) -> None:
    """Guidance says it for late nodes: a controller counts nothing, whatever a stranger said, and a reset works."""
    with running_graph(tmp_path / "run", *WHOLE) as robot:
        guidance = robot.nodes["guidance"]
        assert isinstance(guidance, GuidanceNode)
        stand_unanswered(robot)
        robot.publish(REFERENCE_BASE, reference(0))
        robot.publish(REFERENCE_BASE, reference(AT))
        robot.settle()
        for tick in range(AT + 3):
            guidance._say_again(tick)
            robot.settle()
        assert robot.nodes["controller"].refusals == {}
        robot.simulator.reset()
        go_on(robot)
    assert but_for_publishers(tmp_path / "run_reset1") == undisturbed
