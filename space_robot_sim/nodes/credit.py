"""How far the recorder lets the simulator go: a number that grows during a run and begins again with every reset."""

from __future__ import annotations

from space_robot_msgs_py.codec.codecs import decode_clock
from space_robot_msgs_py.errors import CommandError, LayoutError
from space_robot_msgs_py.nodes.base import GraphNode
from space_robot_msgs_py.topics import RECORDER_CREDIT

# A recorder gives no credit for more ticks than this beyond the state that it may have heard.
MAX_AHEAD = 256


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
