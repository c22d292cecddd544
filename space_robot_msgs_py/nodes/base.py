"""The common ground of all nodes: publishers and subscriptions from the topic table, and how a run ends."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterable
from time import monotonic
from typing import Any

from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.context import Context
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import QoSPolicyKind
from rclpy.qos_overriding_options import QoSOverridingOptions
from rclpy.subscription import Subscription
from rclpy.task import Future
from rclpy.topic_endpoint_info import TopicEndpointInfo

from space_robot_msgs_py.codec.sender_mark import mark_of
from space_robot_msgs_py.errors import LayoutError, SpecError, shortened
from space_robot_msgs_py.escapes import visible
from space_robot_msgs_py.nodes.callers import note_files
from space_robot_msgs_py.nodes.parameters import NodeParameters
from space_robot_msgs_py.nodes.reasons import Reasons
from space_robot_msgs_py.nodes.replies import Replies
from space_robot_msgs_py.parameters import ParameterRow
from space_robot_msgs_py.qos import Qos, asked_of, qos_of
from space_robot_msgs_py.ros import message_class, qos
from space_robot_msgs_py.run_messages import RunBegin, RunEnd, decode_begin, decode_end, encode_end
from space_robot_msgs_py.topics import RUN_BEGIN, RUN_END, Topic

FLUSH_SECONDS = 0.1
# The end of a run may be heard before its name: topics have no order among each other.
NAME_SECONDS = 0.5
MAX_EARLY_ENDS = 8
# What may never come.
DISPENSABLE = ("set_point", "accepted_command", "controller_telemetry", "housekeeping")
OVERRIDABLE = (
    QoSPolicyKind.HISTORY,
    QoSPolicyKind.DEPTH,
    QoSPolicyKind.RELIABILITY,
    QoSPolicyKind.DURABILITY,
)
# Characters of an error that become the reason of an end: with all else fewer than REASON_BYTES in any alphabet.
MAX_REASON = 16_000


class GraphNode(Node):  # type: ignore[misc]
    """A node that exchanges canonical bytes on topics of the table and knows why the run ended.

    Raw bytes are published and taken because one encoder then serves graph and log: equal runs give equal bytes,
    and a tick costs no intermediate message objects.

    Attributes:
        end_reason: why the run ended, once it has.
        over: done when it has; what an executor spins for.
        failure: the exception that stopped this node.
        runs: the runs this node takes part in and how often each was reset, by name; normally there is one.
        refusals: how many messages were refused, by topic.
        reasons: why.
        parameters: what it shows of itself.
        replies: those of its services.

    Args:
        name: node name.
        context: the rclpy context to live in; None is the default context.
        rows: its parameters.
        overridable: history, depth, reliability and durability of every topic are parameters that may be given at the
            start.
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
        note_files()
        self._readers: dict[Topic, Subscription] = {}
        self._qos_options = QoSOverridingOptions(OVERRIDABLE) if overridable else None
        self.parameters = NodeParameters(self, self.tune)
        self.parameters.declare(rows)
        self.end_reason: str | None = None
        self._unsaid: bytes | None = None
        self.over = Future()
        self.failure: Exception | None = None
        self.runs: dict[str, int] = {}
        self.refusals: Counter[str] = Counter()
        self.reasons = Reasons()
        self._early_ends: dict[str, RunEnd] = {}
        self._nameless = self.create_timer(
            NAME_SECONDS, self._end_without_name, clock=Clock(clock_type=ClockType.STEADY_TIME), autostart=False
        )
        self._end_publisher = self.publisher(RUN_END)
        self.listen(RUN_BEGIN, self._on_run_begin)
        self.listen(RUN_END, self._on_run_end)

    @property
    def begun(self) -> bool:
        """True when this node has seen a state of the run; from then on only nodes of that run may end it."""
        return False

    def begin_again(self) -> None:
        """The simulator says that the run was reset: time begins again at 0; by default nothing is to be done."""

    def tune(self, changes: dict[str, Any]) -> None:
        """Take over parameters that were set during the run, all or none; a node without dynamic ones is never asked.

        Raises:
            SpecError: the reason why not.
        """
        raise SpecError("cannot change during the run", key=", ".join(changes))

    def publisher(self, topic: Topic, offer: Qos | None = None) -> Publisher:
        """A publisher of that row of the table, which offers what the table says or something else."""
        profile = qos(offer or qos_of(topic))
        return self.create_publisher(
            message_class(topic), topic.name, profile, qos_overriding_options=self._qos_options
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
            message_class(topic),
            topic.name,
            guarded,
            qos(asked_of(topic)),
            raw=True,
            qos_overriding_options=self._qos_options,
        )
        self._readers[topic] = reader
        return reader

    def end(self, reason: str, *, say: bool = True) -> None:
        """Tell the whole graph that the run is over, and why; the first reason counts.

        Args:
            reason: of the end.
            say: tell the graph now; else it is left to ``say_end``.
        """
        if self.end_reason is None:
            self._hear_end(reason)
            run = next(reversed(self.runs), "")
            self._unsaid = encode_end(RunEnd(run, self.get_fully_qualified_name(), reason))
            if say:
                self.say_end()

    def say_end(self) -> None:
        """Tell the whole graph what ``end`` was not to say yet."""
        if self._unsaid is not None:
            self._end_publisher.publish(self._unsaid)
            self._unsaid = None

    def fail(self, error: Exception) -> None:
        """Keep the error that stopped this node, log it once and end the run with it."""
        self.failure = error
        # An error of this project is short; another may quote anything.
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

    def unheard(self) -> list[str]:
        """Topics that it cannot do without and hears no publisher of."""
        unneeded = {one for one in self._readers if one.sporadic or one.kind in DISPENSABLE} | {RUN_BEGIN, RUN_END}
        return [one.name for one in self._readers if one not in unneeded and self.publisher_count(one) == 0]

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

    def refuse(self, topic: Topic, why: object) -> None:
        """Count a message that is not taken; log each reason now and then, with what the graph knows of its sender."""
        self.refusals[topic.name] += 1
        if said := self.reasons.add(topic.name, str(why)):
            self.get_logger().warning(f"refused a message on {topic.name}: {said}; {self.senders(topic)}")

    def senders(self, topic: Topic, others: Collection[str] = ()) -> str:
        """Which nodes may have sent a message, for logs: the middleware does not tell which one did.

        Args:
            topic: of the message.
            others: full names of nodes which did not send it.
        """
        found = set(self.publishing_nodes(topic)).difference(others, {self.get_fully_qualified_name()})
        return f"published by {' or '.join(sorted(found)) or 'a node that is gone'}"

    def publishers_by_mark(self, topic: Topic) -> dict[bytes, str]:
        """Full names of the nodes that publish a topic, by the mark of their publisher; a query of the graph."""
        found = self.get_publishers_info_by_topic(topic.name)
        return {mark_of(bytes(one.endpoint_gid)): full_name(one) for one in found}

    def publishing_nodes(self, topic: Topic) -> tuple[str, ...]:
        """Full names of the nodes that publish a topic, each once; a query of the graph, not for every tick."""
        found = self.get_publishers_info_by_topic(topic.name)
        return tuple(sorted({full_name(one) for one in found}))

    def hear_begin(self, begin: RunBegin) -> None:
        """Take part in a run, or in another one where its simulator is the only one; a higher number is a reset."""
        number, others = self.runs.get(begin.run), bool(self.runs)
        if number is None and others and self.begun and self._readers[RUN_BEGIN].get_publisher_count() > 1:
            self.refuse(RUN_BEGIN, f"a second simulator; this run is {next(reversed(self.runs))}, that one {begin.run}")
            return
        if number is not None and begin.number <= number:
            return
        self.runs[begin.run] = begin.number
        if number is not None or (others and self.begun):
            self.begin_again()
        early = self._early_ends.pop(begin.run, None)
        if early is not None and self.end_reason is None:
            self._hear_end(early.reason)

    def _on_run_begin(self, raw: bytes) -> None:
        try:
            begin = decode_begin(raw)
        except LayoutError as error:
            self.refuse(RUN_BEGIN, error)
            return
        self.hear_begin(begin)

    def _on_run_end(self, raw: bytes) -> None:
        try:
            end = decode_end(raw)
        except LayoutError as error:
            self.refuse(RUN_END, error)
            return
        if end.run not in self.runs and (end.run or self.begun):
            self._keep(end)
            self.refuse(
                RUN_END, f"{end.node} ends the run {end.run or 'without a name'}, which this node does not know"
            )
        elif self.end_reason is None:
            self._hear_end(end.reason)

    def _end_without_name(self) -> None:
        """A run that was taken part in and never said its name has ended: it is gone, and will not say it any more."""
        if self.runs or self.end_reason is not None:
            self._nameless.cancel()
        elif self.begun:
            self._hear_end([end for run, end in self._early_ends.items() if run][-1].reason)

    def _keep(self, end: RunEnd) -> None:
        """Topics have no order among each other: of a short run the end may come before the begin that names it."""
        if len(self._early_ends) >= MAX_EARLY_ENDS:
            del self._early_ends[next(iter(self._early_ends))]
        self._early_ends[end.run] = end
        if end.run and not self.runs:
            self._nameless.reset()

    def _hear_end(self, reason: str) -> None:
        self.end_reason = reason
        self.over.set_result(None)


def full_name(endpoint: TopicEndpointInfo) -> str:
    """Name and namespace of the node that an endpoint belongs to."""
    return f"{endpoint.node_namespace.rstrip('/')}/{endpoint.node_name}"
