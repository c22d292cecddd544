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
    that is.

    Args:
        periods: of silence, after which the other one takes over.

    Attributes:
        acting: name of the node whose turn it is.
        answered: to how many states of the run there was an answer.
    """

    def __init__(self, periods: int) -> None:
        self._periods = periods
        self.restart()

    def restart(self) -> None:
        """A new run."""
        self.acting, self.answered = CONTROLLERS[0], 0
        self._silent, self._allowed = 0, self._periods

    def admits(self, sender: str) -> bool:
        """Whether a node, by its full name, may answer now."""
        return sender.rpartition("/")[2] == self.acting

    def answer(self) -> None:
        """A state has its answer."""
        self.answered += 1
        self._silent, self._allowed = 0, self._periods

    def pass_by(self) -> None:
        """A period is over without its command."""
        self._silent += 1
        if self._silent >= self._allowed:
            self._silent, self._allowed = 0, PATIENCE * self._periods
            self.acting = CONTROLLERS[CONTROLLERS[0] == self.acting]
