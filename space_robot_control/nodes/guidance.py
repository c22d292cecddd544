"""Guidance node: publishes references ahead of the states they are for."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from space_robot_msgs_py.codec.codecs import ReferenceCodec, peek_stamp
from space_robot_msgs_py.errors import LayoutError
from space_robot_msgs_py.interfaces import ReferenceSource
from space_robot_msgs_py.nodes.attitude import AttitudePublisher
from space_robot_msgs_py.nodes.base import GraphNode
from space_robot_msgs_py.nodes.offers import Offers
from space_robot_msgs_py.nodes.sending import publish_all, sending
from space_robot_msgs_py.topics import BASE_ODOM, REFERENCE_ATTITUDE


class GuidanceNode(GraphNode):
    """Publishes the reference of every tick up to ``ahead`` ticks before the robot gets there.

    A reference is a function of time, so the controller never waits for it. A state that is none of this run, or far
    ahead of it without a second one that follows, moves nothing.

    To a node that is matched later, and does not ask for what was published before, references that were out by then
    are said again, each when its state is there: one at a time, so that a short queue holds them.

    Args:
        reference: the motion, ready made.
        joint_names: the robot's joints in model order.
        period: control period [ns].
        steps: number of periods of the run; ticks 0..steps get a reference.
        ahead: how many ticks ahead [-].
        options: see GraphNode.
    """

    def __init__(
        self,
        reference: ReferenceSource,
        joint_names: tuple[str, ...],
        *,
        period: int,
        steps: int,
        ahead: int = 16,
        name: str = "guidance",
        **options: Any,
    ) -> None:
        super().__init__(name, **options)
        self._reference = reference
        self._codec = ReferenceCodec(joint_names)
        self._period, self._steps, self._ahead = period, steps, ahead
        self._next, self._reached, self._doubted = 0, -1, -1
        publishers = [self.publisher(topic) for topic in self._codec.topics]
        self._senders = [sending(publisher) for publisher in publishers]
        self._attitude = AttitudePublisher(self, REFERENCE_ATTITUDE)
        # The newest that are out, and the last tick whose reference a late node needs again.
        self._out: dict[int, Sequence[bytes]] = {}
        self._again_until = -1
        self._offers = Offers(self, self._waiting, lambda: self._say_again(self._reached), on_match=self._on_late_node)
        self._offers.begin(publishers)
        self._publish_until(ahead)
        self.listen(BASE_ODOM, self._on_state)

    @property
    def begun(self) -> bool:
        """True when a state was heard."""
        return self._reached >= 0

    def begin_again(self) -> None:
        """The plant was reset: time starts again, and so do the references."""
        self._next, self._reached, self._doubted = 0, -1, -1
        self._out.clear()
        self._again_until = -1
        self._publish_until(self._ahead)

    def reached(self, tick: int) -> None:
        """The robot has got to a tick of the run; by default nothing is to be done."""

    def _on_state(self, raw: bytes) -> None:
        try:
            stamp = peek_stamp(raw)
        except LayoutError as error:
            self.refuse(BASE_ODOM, error)
            return
        tick, rest = divmod(stamp, self._period)
        if rest or tick > self._steps:
            accepted = f"multiples of {self._period} ns up to {self._steps * self._period} ns"
            self.refuse(BASE_ODOM, LayoutError("not a tick of this run", key="stamp", value=stamp, accepted=accepted))
        elif tick <= self._next or tick == self._doubted + 1:
            self._reached = max(self._reached, tick)
            if tick <= self._again_until:
                self._say_again(tick)
            self._publish_until(tick + self._ahead)
            self.reached(tick)
        else:
            # Beyond all references that are out: states were lost, or this is none. The next one tells.
            self._doubted = tick

    def _waiting(self) -> int | None:
        """Stamp of the newest state [ns]; whether it has its answer is not known here, and does not matter."""
        return self._reached * self._period if self.begun and self.end_reason is None else None

    def _on_late_node(self) -> None:
        self._again_until = self._next - 1

    def _say_again(self, tick: int) -> None:
        """The reference of a tick, as it was."""
        if tick in self._out:
            publish_all(self._senders, self._out[tick])

    def _publish_until(self, tick: int) -> None:
        while self._next <= min(tick, self._steps):
            desired = self._reference.at(self._next * self._period)
            parts = self._out[self._next] = self._codec.encode(desired)
            publish_all(self._senders, parts)
            self._out.pop(self._next - 2 * (self._ahead + 1), None)
            self._attitude.show(desired.stamp, desired.q)
            self._next += 1
