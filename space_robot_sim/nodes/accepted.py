"""Which commands the simulator accepted: what a recorder must know once more than one node commands."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Mapping, Sequence

import numpy.typing as npt

from space_robot_msgs_py.codec.codecs import TelemetryCodec
from space_robot_msgs_py.interfaces import Command, Telemetry
from space_robot_msgs_py.nodes.base import GraphNode
from space_robot_msgs_py.topics import ACCEPTED_COMMAND

# More than a simulator may be ahead of its recorder.
KEPT = 512
NOTHING: Mapping[str, npt.ArrayLike] = {"wrench": (), "effort": ()}


class AcceptedCommands:
    """Remembers the newest accepted commands, and publishes them from the moment a node listens.

    Where one node commands no other knows more than it, and nothing is published. Two recorders of two publishers may
    hear them in different orders: what acted is then known to the simulator alone.

    Args:
        node: the node to publish on.
    """

    def __init__(self, node: GraphNode) -> None:
        self._publisher = node.publisher(ACCEPTED_COMMAND)
        # Of the handle itself: it is asked at every tick.
        self._count = self._publisher.handle.get_subscription_count
        self._codec = TelemetryCodec(ACCEPTED_COMMAND)
        self._kept: OrderedDict[int, tuple[Command | None, Sequence[bytes]]] = OrderedDict()
        self._listened = False

    def clear(self) -> None:
        """Forget all of a run that is over."""
        self._kept.clear()

    def add(self, command: Command, parts: Sequence[bytes]) -> None:
        """Keep a command and its messages."""
        self._keep(command.stamp, command, parts)

    def add_none(self, stamp: int) -> None:
        """There was no command that could be used, and the plant holds from this stamp [ns] on."""
        self._keep(stamp, None, ())

    def parts(self, stamp: int) -> Sequence[bytes] | None:
        """The messages of the command accepted for a stamp [ns]; empty: none could be used; None: not known."""
        kept = self._kept.get(stamp)
        return None if kept is None else kept[1]

    def look(self) -> None:
        """Publish what is kept when the first listener is there; afterwards every command goes out at once."""
        if not self._listened and self._count() > 0:
            self._listened = True
            for stamp, (command, _) in self._kept.items():
                self._publish(stamp, command)

    def _keep(self, stamp: int, command: Command | None, parts: Sequence[bytes]) -> None:
        if self._listened:
            self._publish(stamp, command)
        self._kept[stamp] = command, parts
        if len(self._kept) > KEPT:
            self._kept.popitem(last=False)
        self.look()

    def _publish(self, stamp: int, command: Command | None) -> None:
        blocks = NOTHING if command is None else {"wrench": command.wrench, "effort": command.effort}
        self._publisher.publish(self._codec.encode(Telemetry.of(stamp, blocks))[0])
