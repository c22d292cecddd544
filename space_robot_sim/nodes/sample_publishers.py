"""How a simulator shows a sample of its plant: events, state and telemetry, then the clock and what tools want."""

from __future__ import annotations

from collections.abc import Callable, Collection

from rclpy.publisher import Publisher

from space_robot_msgs_py.codec.codecs import (
    StateCodec,
    TelemetryCodec,
    WheelMomentumCodec,
    encode_clock,
    encode_tick_statuses,
    plant_events,
)
from space_robot_msgs_py.interfaces import PlantSample
from space_robot_msgs_py.nodes.base import GraphNode
from space_robot_msgs_py.nodes.sending import publish_all, sending
from space_robot_msgs_py.qos import Qos
from space_robot_msgs_py.topics import CLOCK, PLANT_TELEMETRY, Topic
from space_robot_sim.nodes.transforms import TransformPublisher


class SamplePublishers:
    """Publishes samples.

    Args:
        node: in whose name.
        joint_names: the robot's joints in model order.
        urdf: of the nominal robot, for its frames.
        optional: the optional topics of this run.
        offer: quality of service of a topic.

    Attributes:
        awaited: publishers of what the other nodes of a run wait for.
    """

    def __init__(
        self,
        node: GraphNode,
        joint_names: tuple[str, ...],
        urdf: str,
        optional: Collection[Topic],
        offer: Callable[[Topic], Qos],
    ) -> None:
        self._states, self._wheels = StateCodec(joint_names), WheelMomentumCodec()
        self._telemetry = TelemetryCodec(PLANT_TELEMETRY)
        measured = [one for one in optional if one.kind == "state"]
        # The part that only some runs have comes first: a stranger's, sent ahead of time, is replaced before the rest.
        topics = (*measured, *self._states.topics, PLANT_TELEMETRY)
        self.awaited: list[Publisher] = [node.publisher(topic, offer(topic)) for topic in topics]
        self._send = [sending(publisher) for publisher in self.awaited]
        self._events = {one: sending(node.publisher(one, offer(one))) for one in optional if one.kind == "plant_event"}
        clock = node.publisher(CLOCK)
        self._clock, self._clock_readers = sending(clock), clock.handle.get_subscription_count
        self._transforms = TransformPublisher(node, urdf, joint_names)

    def show(self, sample: PlantSample) -> None:
        """A new sample, with all that tools want to know of it."""
        self.say(sample)
        # It is volatile, as all that only tools read: where none listens it would be kept for none.
        if self._clock_readers():
            self._clock(encode_clock(sample.state.stamp))
        self._transforms.show(sample.state)

    def say(self, sample: PlantSample) -> None:
        """What a run consists of, also for the second time."""
        state = sample.state
        if self._events:
            # At every tick: topics have no order among each other, and the recorder waits for what it expects only.
            events = dict(plant_events(sample))
            for topic, send in self._events.items():
                send(encode_tick_statuses(state.stamp, events.get(topic, ())))
        wheels, parts = self._wheels.of(state), self._states.encode(state)
        measured = parts if wheels is None else (wheels, *parts)
        publish_all(self._send, (*measured, *self._telemetry.encode(sample.telemetry)))
