"""What a simulator says of a sample, and in which order."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("rclpy")

from space_robot_msgs_py.codec.codecs import decode_clock
from space_robot_msgs_py.events import ERROR, DiagnosticEvent
from space_robot_msgs_py.interfaces import PlantSample, RobotState, Telemetry
from space_robot_msgs_py.qos import qos_of
from space_robot_msgs_py.topics import CLOCK, FAULTS, PLANT_TELEMETRY, TF, TF_STATIC, WHEEL_MOMENTUM, Topic, topics_of
from space_robot_sim.nodes.sample_publishers import SamplePublishers

pytestmark = pytest.mark.ros
STATE = RobotState(
    300_000_000, np.array([1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0, 0.5]), np.zeros(7), np.zeros(1), np.zeros(3), np.ones(3)
)
SAMPLE = PlantSample(
    STATE, Telemetry.of(STATE.stamp, {"energy": 1.0}), (DiagnosticEvent(STATE.stamp, ERROR, "a", "b", "c", ()),)
)


class Node:
    """It keeps what is sent."""

    def __init__(self, listeners: int = 0) -> None:
        self.heard: list[tuple[Topic, bytes]] = []
        self.listeners = listeners

    def publisher(self, topic: Topic, offer: Any = None) -> SimpleNamespace:
        """One that sends bytes; tf2_msgs is not installed."""
        if topic in (TF, TF_STATIC):
            raise ModuleNotFoundError("No module named 'tf2_msgs'")
        handle = SimpleNamespace(
            publish_raw=lambda raw: self.heard.append((topic, raw)), get_subscription_count=lambda: self.listeners
        )
        return SimpleNamespace(handle=handle, publish=handle.publish_raw)


@pytest.mark.parametrize("listeners", [0, 1])
def test_a_sample_is_said_with_its_telemetry_last_and_the_clock_where_one_listens(listeners: int) -> None:
    """Events and what only some runs have go first, for a tick that is there to its end is there as a whole."""
    node = Node(listeners)
    samples = SamplePublishers(node, ("hinge",), "<robot/>", (FAULTS, WHEEL_MOMENTUM), qos_of)  # type: ignore[arg-type]
    samples.say(SAMPLE)
    said = [FAULTS, WHEEL_MOMENTUM, *topics_of("state"), PLANT_TELEMETRY]
    assert [topic for topic, _ in node.heard] == said
    again = node.heard.copy()
    node.heard.clear()
    samples.show(SAMPLE)
    assert node.heard[: len(again)] == again
    clocks = [decode_clock(raw) for topic, raw in node.heard if topic is CLOCK]
    assert clocks == [STATE.stamp] * listeners
    assert len(samples.awaited) == len(said) - 1
