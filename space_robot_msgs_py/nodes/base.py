"""The common ground of all nodes: publishers and subscriptions from the topic table, and how a run ends."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

from rclpy.context import Context
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos_overriding_options import QoSOverridingOptions
from rclpy.subscription import Subscription
from rclpy.task import Future

from space_robot_msgs_py.codecs import decode_string, encode_string
from space_robot_msgs_py.errors import LayoutError, SpecError, shortened
from space_robot_msgs_py.escapes import visible
from space_robot_msgs_py.limits import REASON_BYTES
from space_robot_msgs_py.nodes.parameters import NodeParameters
from space_robot_msgs_py.parameters import ParameterRow
from space_robot_msgs_py.ros import message_class, qos
from space_robot_msgs_py.topics import RUN_END, Topic

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
        super().__init__(name, context=context, **options)
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

        return self.create_subscription(
            message_class(topic), topic.name, guarded, qos(topic), raw=True, qos_overriding_options=self._qos_options
        )

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

    def flush(self, seconds: float) -> None:
        """Wait until everything published is acknowledged by every matched subscriber, at most that long each."""
        for publisher in self.publishers:
            publisher.wait_for_all_acked(Duration(seconds=seconds))

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
