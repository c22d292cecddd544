"""Which commands the simulator accepted: what others must know where the graph alone does not tell."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Collection, Sequence

from space_robot_msgs_py.codec.codecs import Accepted, AcceptedCodec, decode_events
from space_robot_msgs_py.errors import SpaceRobotError
from space_robot_msgs_py.events import ControllerEvent
from space_robot_msgs_py.interfaces import Command
from space_robot_msgs_py.nodes.base import GraphNode
from space_robot_msgs_py.topics import ACCEPTED_COMMAND, CONTROLLER_EVENTS
from space_robot_sim.nodes.turns import Turns

# More than a simulator may be ahead of its recorder.
KEPT = 512


class AcceptedCommands:
    """Remembers the newest accepted commands, and publishes them.

    In lock-step from the moment a node listens: where one node commands no other knows more than it. Two recorders of
    two publishers may hear them in different orders: what acted is then known to the simulator alone. In a paced run
    always, with one message at least for every period: who has heard of a period knows all that was accepted before.
    Of two controllers each learns from it what the log has of the other one: its commands, and its events with them.

    Args:
        node: the node to publish on.
        always: in a paced run.
        turns: of a run with two controllers; None: there is one.
    """

    def __init__(self, node: GraphNode, *, always: bool = False, turns: Turns | None = None) -> None:
        self._publisher = node.publisher(ACCEPTED_COMMAND)
        # Of the handle itself: it is asked at every tick.
        self._count = self._publisher.handle.get_subscription_count
        self._codec = AcceptedCodec()
        self._kept: OrderedDict[int, tuple[Command | None, Sequence[bytes]]] = OrderedDict()
        self._listened, self.turns = always, turns
        self._node, self._events = node, OrderedDict[int, tuple[ControllerEvent, ...]]()
        if turns is not None:
            node.listen(CONTROLLER_EVENTS, self._on_events)

    def clear(self) -> None:
        """Forget all of a run that is over."""
        self._kept.clear()
        self._events.clear()
        if self.turns is not None:
            self.turns.restart()

    def add(self, command: Command, parts: Sequence[bytes]) -> None:
        """Keep a command and its messages."""
        if self.turns is not None:
            self.turns.answer(command.stamp)
        self._keep(command.stamp, command, parts)

    def add_none(self, stamp: int) -> None:
        """There was no command that could be used, and the plant holds from this stamp [ns] on."""
        self._keep(stamp, None, ())

    def pass_by(self, stamp: int) -> None:
        """Paced: the period that began at this stamp [ns] is over without its command, which may still come."""
        if self.turns is not None:
            self.turns.pass_by(stamp)
        self._publish(Accepted(stamp, None))

    def add_too_late(self, command: Command, parts: Sequence[bytes], awaited: int) -> None:
        """Paced: a command that can act no more, of which a replay has to know that its state was answered.

        Of two controllers it is refused: the one that sent it begins its turn again after the ``awaited`` state [ns].
        """
        if self.turns is not None:
            self.turns.restart_turn(awaited)
            self._publish(Accepted(command.stamp, None, too_late=True))
            return
        self._remember(command.stamp, command, parts)
        self._publish(Accepted(command.stamp, command, too_late=True))

    @property
    def kept(self) -> Collection[int]:
        """Stamps of the newest states whose commands are known [ns]."""
        return self._kept.keys()

    def parts(self, stamp: int) -> Sequence[bytes] | None:
        """The messages of the command accepted for a stamp [ns]; empty: none could be used; None: not known."""
        kept = self._kept.get(stamp)
        return None if kept is None else kept[1]

    def look(self) -> None:
        """Publish what is kept when the first listener is there; afterwards every command goes out at once."""
        if not self._listened and self._count() > 0:
            self._listened = True
            for stamp, (command, _) in self._kept.items():
                self._publish(Accepted(stamp, command))

    def _keep(self, stamp: int, command: Command | None, parts: Sequence[bytes]) -> None:
        if self._listened:
            self._publish(Accepted(stamp, command))
        self._remember(stamp, command, parts)
        self.look()

    def _remember(self, stamp: int, command: Command | None, parts: Sequence[bytes]) -> None:
        self._kept[stamp] = command, parts
        if len(self._kept) > KEPT:
            self._kept.popitem(last=False)

    def _publish(self, said: Accepted) -> None:
        if self.turns is not None:
            events = () if said.command is None else self._events.get(said.stamp, ())
            turns = self.turns
            said = said._replace(acting=turns.acting, answered=turns.answered, since=turns.since, events=events)
        self._publisher.publish(self._codec.encode(said))

    def _on_events(self, raw: bytes) -> None:
        """A controller says what belongs to the command that it sends next, when this one has it."""
        try:
            events = decode_events(raw)
        except SpaceRobotError as error:
            self._node.refuse(CONTROLLER_EVENTS, error)
            return
        self._events[events[0].stamp] = events
        if len(self._events) > KEPT:
            self._events.popitem(last=False)
