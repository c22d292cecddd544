"""A state is offered again to a node that came too late for it: what is volatile is not kept for late joiners."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.publisher import Publisher
from rclpy.subscription import Subscription

from space_robot_msgs_py.nodes.base import GraphNode

LOOK_SECONDS = 0.1
# After a new node was matched. The two ends of a match do not know of it at the same time, so an answer may be lost.
OFFER_AFTER = (0.0, 1.0, 3.0, 10.0)
FORGET_AFTER = 15.0


class Offers:
    """Says a state again while it waits, a few times after a node was matched that may not have heard it.

    A node that has answered it answers again, for its answer may be lost; to others it is no news. A state that
    was not there a tenth of a second before is not said again: a run that goes on needs nothing.

    Args:
        node: whose executor runs the timer.
        waiting: stamp of the newest state where it waits [ns]; None: it does not.
        offer: says it again.
        readers: of the answers.
        on_match: called when a node was matched that was not there before.
    """

    def __init__(
        self,
        node: GraphNode,
        waiting: Callable[[], int | None],
        offer: Callable[[], None],
        readers: Sequence[Subscription] = (),
        on_match: Callable[[], None] = lambda: None,
    ) -> None:
        self._node, self._waiting, self._offer, self._readers = node, waiting, offer, readers
        self._on_match = on_match
        self._publishers: Sequence[Publisher] = ()
        self._matched: tuple[int, ...] = ()
        self._seen: int | None = None
        self._clock = Clock(clock_type=ClockType.STEADY_TIME)
        self._since, self._tries = self._clock.now(), len(OFFER_AFTER)
        self._timer = node.create_timer(LOOK_SECONDS, self._look, clock=self._clock)

    def begin(self, publishers: Sequence[Publisher]) -> None:
        """The first state of a run was said on these publishers, to those that are matched now."""
        self._publishers, self._matched = publishers, ()
        self._matched, self._seen = self._count(), None
        # Of those the answers may be lost.
        self._since, self._tries = self._clock.now(), 1

    def stop(self) -> None:
        """The publishers are gone."""
        self._publishers, self._tries = (), len(OFFER_AFTER)
        self._matched = self._count()

    def _count(self) -> tuple[int, ...]:
        return (
            *(publisher.handle.get_subscription_count() for publisher in self._publishers),
            *(reader.handle.get_publisher_count() for reader in self._readers),
        )

    def _look(self) -> None:
        try:
            matched = self._count()
            if any(now > before for now, before in zip(matched, self._matched, strict=False)):
                self._since, self._tries = self._clock.now(), 0
                self._on_match()
            stamp, seen = self._waiting(), self._seen
            self._matched, self._seen = matched, stamp
            if stamp is not None and stamp == seen and self._is_due():
                self._tries += 1
                self._offer()
        except Exception as error:
            self._node.fail(error)

    def _is_due(self) -> bool:
        passed = (self._clock.now() - self._since).nanoseconds * 1e-9
        return self._tries < len(OFFER_AFTER) and OFFER_AFTER[self._tries] <= passed < FORGET_AFTER
