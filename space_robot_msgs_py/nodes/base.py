"""The common ground of all nodes: publishers and subscriptions from the topic table, and how a run ends."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from time import monotonic
from typing import Any

from rclpy.context import Context
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos_overriding_options import QoSOverridingOptions
from rclpy.subscription import Subscription
from rclpy.task import Future

from space_robot_msgs_py.codec.codecs import decode_string, encode_string
from space_robot_msgs_py.errors import LayoutError, SpecError, shortened
from space_robot_msgs_py.escapes import visible
from space_robot_msgs_py.limits import REASON_BYTES
from space_robot_msgs_py.nodes.parameters import NodeParameters
from space_robot_msgs_py.nodes.replies import Replies
from space_robot_msgs_py.parameters import ParameterRow
from space_robot_msgs_py.ros import message_class, qos
from space_robot_msgs_py.topics import RUN_END, Topic

FLUSH_SECONDS = 0.1
# Characters of an error that become the reason of an end: fewer than REASON_BYTES in any alphabet.
MAX_REASON = 16_000


class GraphNode(Node):  # type: ignore[misc]
    """A node that exchanges canonical bytes on topics of the table and knows why the run ended.

    Raw bytes are published and taken because one encoder then serves graph and log: equal runs give equal bytes,
    and a tick costs no intermediate message objects.

    Attributes:
        end_reason: why the run ended, once it has.
        over: done when it has; what an executor spins for.
        failure: the exception that stopped this node.
        parameters: what it shows of itself.
        replies: those of its services.

    Args:
        name: node name.
        context: the rclpy context to live in; None is the default context.
        rows: its parameters.
        overridable: history, depth and reliability of every topic are parameters that may be given at the start.
        options: further keyword arguments of rclpy.node.Node, e.g. ``namespace``.
    """

    def __init__(
        self,
        name: str,
        *,
        context: Context | None = None,
        rows: Iterable[ParameterRow] = (),
        overridable: bool = False,
        **options: Any,
    ) -> None:
        # Before the services of ROS itself, which are made in there.
        self.replies = Replies()
        super().__init__(name, context=context, **options)
        self.replies.start(self)
        self._readers: dict[Topic, Subscription] = {}
        self._qos_options = QoSOverridingOptions.with_default_policies() if overridable else None
        self.parameters = NodeParameters(self, self.tune)
        self.parameters.declare(rows)
        self.end_reason: str | None = None
        self.over = Future()
        self.failure: Exception | None = None
        self._end_publisher = self.publisher(RUN_END)
        self.listen(RUN_END, self._on_run_end)

    def tune(self, changes: dict[str, Any]) -> None:
        """Take over parameters that were set in flight, all or none; a node without dynamic ones is never asked.

        Raises:
            SpecError: the reason why not.
        """
        raise SpecError("cannot change in flight", key=", ".join(changes))

    def publisher(self, topic: Topic) -> Publisher:
        """A publisher of that row of the table."""
        return self.create_publisher(
            message_class(topic), topic.name, qos(topic), qos_overriding_options=self._qos_options
        )

    def create_service(self, *arguments: Any, **options: Any) -> Any:
        """As of every node, but the reply waits for a client that is discovered later than its request."""
        service = super().create_service(*arguments, **options)
        self.replies.guard([service])
        return service

    def listen(self, topic: Topic, callback: Callable[[bytes], None]) -> Subscription:
        """Subscribe to the raw bytes of that row of the table.

        An exception in a callback would be lost in the executor: it is kept in ``failure`` and ends the run.
        """

        def guarded(raw: bytes) -> None:
            if self.failure is not None:
                return
            try:
                callback(raw)
            except Exception as error:
                self.fail(error)

        reader = self.create_subscription(
            message_class(topic), topic.name, guarded, qos(topic), raw=True, qos_overriding_options=self._qos_options
        )
        self._readers[topic] = reader
        return reader

    def end(self, reason: str) -> None:
        """Tell the whole graph that the run is over, and why; the first reason counts."""
        if self.end_reason is None:
            self._hear_end(reason)
            self._end_publisher.publish(encode_string(reason))

    def fail(self, error: Exception) -> None:
        """Keep the error that stopped this node, log it once and end the run with it."""
        self.failure = error
        # An error of ours is short; another may quote anything.
        said = shortened(visible(str(error)), MAX_REASON)
        self.get_logger().error(said)
        self.end(f"{self.get_name()}: {said}")

    def publisher_count(self, topic: Topic) -> int | None:
        """How many publishers this node hears on a topic; None where it does not listen to it."""
        reader = self._readers.get(topic)
        # A reader that was destroyed, as by a cleanup, is no longer among them.
        if reader is None or not any(one is reader for one in self.subscriptions):
            return None
        return int(reader.get_publisher_count())

    def flush(self, seconds: float, hurried: Callable[[], bool] = lambda: False) -> None:
        """Wait until all replies are sent and all messages acknowledged by every matched subscriber, that long in all.

        Args:
            seconds: at most.
            hurried: asked often; True: wait no longer.
        """
        deadline = monotonic() + seconds
        self.replies.flush(seconds, hurried)
        for publisher in self.publishers:
            while not publisher.wait_for_all_acked(Duration(seconds=FLUSH_SECONDS)):
                if monotonic() > deadline or hurried():
                    return

    def _on_run_end(self, raw: bytes) -> None:
        try:
            reason = decode_string(raw, REASON_BYTES)
        except LayoutError as error:
            self.get_logger().warning(f"ignored a malformed {RUN_END.name}: {error}")
            return
        if self.end_reason is None:
            self._hear_end(reason)

    def _hear_end(self, reason: str) -> None:
        self.end_reason = reason
        self.over.set_result(None)


def publish_all(publishers: Sequence[Publisher], parts: Sequence[bytes]) -> None:
    """Publish the parts of one value, each on its topic."""
    for publisher, part in zip(publishers, parts, strict=True):
        publisher.publish(part)
