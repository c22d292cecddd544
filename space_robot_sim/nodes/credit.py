"""How far the recorder lets the simulator go: a number that grows during a run and begins again with every reset."""

from __future__ import annotations

from space_robot_msgs_py.codec.codecs import decode_clock, encode_clock
from space_robot_msgs_py.errors import CommandError, LayoutError
from space_robot_msgs_py.nodes.base import GraphNode
from space_robot_msgs_py.topics import RECORDER_CREDIT

# A recorder gives no credit for more ticks than this beyond the state that it may have heard; its queues hold more.
MAX_AHEAD = 800
# The simulator may be so many ticks ahead of what is on the disk. Where the recorder can die alone, no further than the
# tick that is being recorded, or what it had heard would be lost with it.
AHEAD_IN_ONE_PROCESS, AHEAD_BESIDE = 256, 0
# Paced, ticks wait for their commands, and credit is given by halves.
AHEAD_PACED = MAX_AHEAD


class Credit:
    """What a recorder gave for this run.

    Within a run credit only grows. That of the run before, of which some may still be under way when it was reset, is
    recognised by that, too: a recorder begins again with its smallest one, and until then nothing counts.

    Args:
        node: the simulator, which refuses what is no credit.

    Attributes:
        until: stamp of the last state that may be published [ns]; -1: none.
    """

    def __init__(self, node: GraphNode) -> None:
        self._node = node
        self.until = self._old = -1

    @property
    def given(self) -> bool:
        """True when the run may start."""
        return self.until >= 0

    def restart(self) -> None:
        """Wait for the credit of a new run."""
        self._old = max(self._old, self.until)
        self.until = -1

    def take(self, raw: bytes, stamp: int, period: int) -> bool:
        """Take a message of the recorder; False where it changes nothing.

        Args:
            raw: the message.
            stamp: of the newest state [ns]; a recorder cannot have heard more.
            period: control period [ns].
        """
        try:
            until = decode_clock(raw)
        except LayoutError as error:
            self._node.refuse(RECORDER_CREDIT, error)
            return False
        if self._old >= 0 and until > self._old:
            self._old = until
            return False
        most = stamp + (1 + MAX_AHEAD) * period
        if until > most or until % period:
            accepted = f"multiples of {period} ns up to {most} ns"
            self._node.refuse(
                RECORDER_CREDIT, CommandError("not a credit", key=RECORDER_CREDIT.name, value=until, accepted=accepted)
            )
            return False
        self._old = -1
        if until <= self.until:
            return False
        self.until = until
        return True


class CreditGiver:
    """Gives credit for a run, by halves, so that nothing waits for it.

    Args:
        node: the recorder.
        period: control period [ns].
        ahead: ticks that the simulator may be ahead of the log.
    """

    def __init__(self, node: GraphNode, period: int, ahead: int) -> None:
        self._period, self._ahead, self._given = period, ahead, -1
        self._publisher = node.publisher(RECORDER_CREDIT)

    def give(self, next_stamp: int, *, heard: bool) -> None:
        """Give credit, first of all for state 0 alone, which is said until it is heard.

        Args:
            next_stamp: all ticks before it [ns] are in the log.
            heard: the first state was heard, so that those after it will be.
        """
        reach = next_stamp + self._ahead * self._period if heard else 0
        enough = self._given + (self._ahead // 2 * self._period if self._given > 0 else 1)
        if reach >= enough:
            self._given = reach
            self._publisher.publish(encode_clock(reach))

    def restart(self) -> None:
        """A new run begins with its smallest credit."""
        self._given = -1
