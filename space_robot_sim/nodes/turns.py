"""Of two controllers one acts at a time: the simulator knows which of them answers the state that comes next."""

from __future__ import annotations

from space_robot_msgs_py.codec.accepted import CONTROLLERS

# A controller that takes over, and may be stopped itself, gets so many times as long before the turn goes back.
PATIENCE = 4


class Turns:
    """Whose turn it is to answer.

    The first controller begins. After so many periods in a row without an answer it is the turn of the other one, which
    has ``PATIENCE`` times as long for its first answer. A turn changes at the end of a period only, and every node is
    notified of it with what became of the command of that period: so each knows, before it answers a state, whose turn
    that is. In a turn only states of that turn are answered, in their order: those that come after the end of the
    period at which it began. An answer to any other state is refused, from either of them; so the answers that count
    are, by their stamps, those of one turn after those of another one.

    Where an answer comes too late to act, its controller begins its turn again, with the state after the one that
    waits: it learns so, before it answers that state, that its law remembers what the run does not.

    Args:
        periods: of silence, after which the other one takes over.
        period: control period [ns].

    Attributes:
        acting: name of the node whose turn it is.
        since: stamp of the first state of its turn [ns].
        answered: to how many states of the run there was an answer.
    """

    def __init__(self, periods: int, period: int) -> None:
        self._periods, self._period = periods, period
        self.restart()

    def restart(self) -> None:
        """A new run."""
        self.acting, self.since, self.answered = CONTROLLERS[0], 0, 0
        self._silent, self._allowed, self._newest = 0, self._periods, -1

    def refusal(self, sender: str, stamp: int) -> str:
        """Why a node, by its full name, may not answer the state of this stamp [ns] now; empty: it may."""
        if sender.rpartition("/")[2] != self.acting:
            return f"it is the turn of {self.acting}"
        if stamp < self.since:
            return f"stamp {stamp} ns is before its turn, which began at {self.since} ns"
        return f"the state at {self._newest} ns is answered, which is newer" if stamp < self._newest else ""

    def answer(self, stamp: int) -> None:
        """The state of this stamp [ns] has its answer."""
        self.answered, self._newest = self.answered + 1, stamp
        self._silent, self._allowed = 0, self._periods

    def pass_by(self, stamp: int) -> None:
        """The period that began at this stamp [ns] is over without its command."""
        self._silent += 1
        if self._silent >= self._allowed:
            self._begin(CONTROLLERS[CONTROLLERS[0] == self.acting], stamp, PATIENCE * self._periods)

    def restart_turn(self, awaited: int) -> None:
        """An answer of the one that acts came too late, while the state of this stamp [ns] waits."""
        self._begin(self.acting, awaited, self._periods)

    def _begin(self, node: str, stamp: int, allowed: int) -> None:
        self.acting, self.since = node, stamp + self._period
        self._silent, self._allowed = 0, allowed
