"""What a paced log lacks is counted: messages that came too late, and commands that acted and are not in it."""

from __future__ import annotations

from space_robot_msgs_py.codec.codecs import TelemetryCodec
from space_robot_msgs_py.interfaces import Telemetry
from space_robot_msgs_py.topics import JOINT_COMMAND, PLANT_TELEMETRY, WRENCH_COMMAND, Topic
from space_robot_sim.nodes.left_out import ACTED, LeftOut

PERIOD = 10


def tick(stamp: int, acted: int, *, answered: bool = True) -> dict[Topic, bytes]:
    """What is written at a stamp, after a period under the command ``acted``."""
    (telemetry,) = TelemetryCodec(PLANT_TELEMETRY).encode(Telemetry.of(stamp, {ACTED: float(acted)}))
    return {PLANT_TELEMETRY: telemetry} | ({WRENCH_COMMAND: b"w", JOINT_COMMAND: b"j"} if answered else {})


def test_commands_that_acted_are_looked_for_in_what_is_written() -> None:
    """Acting late, again and from the hold is well; a command that no tick has, half a command and a gap are not."""
    left_out = LeftOut(PERIOD)
    for stamp, acted in ((0, -1), (10, 0), (20, -1), (30, 10), (40, 10)):
        left_out.look(stamp, tick(stamp, acted, answered=stamp != 20))
    assert left_out.unrecorded == 0
    left_out.look(50, tick(50, 20))
    left_out.look(70, tick(70, 60))
    assert left_out.unrecorded == 2
    left_out.look(80, {PLANT_TELEMETRY: b"garbage"})
    assert left_out.report() == ["2 periods were run with commands that are not in the log"]


def test_late_messages_are_reported_by_topic_and_late_answers_once() -> None:
    """Every message counts; stamps of states that were answered are given out once."""
    left_out = LeftOut(PERIOD)
    for topic in (JOINT_COMMAND, WRENCH_COMMAND, JOINT_COMMAND):
        left_out.add(topic)
    for stamp in (0, PERIOD):
        left_out.add_answer(stamp)
    assert left_out.answered() == [0, PERIOD]
    assert left_out.answered() == []
    (line,) = left_out.report()
    assert line.endswith("not in the log: 1 on base/wrench_command, 2 on joint_command")
