"""One of two controllers of a paced run: one acts, the other one stands by, hot, and takes over when it is its turn."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Any, cast

from space_robot_control.laws.base import Law
from space_robot_control.nodes.controller import ControllerNode
from space_robot_msgs_py.codec.accepted import CONTROLLERS
from space_robot_msgs_py.codec.codecs import Accepted, AcceptedCodec
from space_robot_msgs_py.errors import SpaceRobotError
from space_robot_msgs_py.interfaces import Reference, RobotState, SupervisedController
from space_robot_msgs_py.topics import ACCEPTED_COMMAND

# States that are kept until it is known what became of their commands; as many periods late a command may be.
KEPT = 128
Inputs = tuple[RobotState, Reference, tuple[bytes, ...]]


class RedundantControllerNode(ControllerNode):
    """A controller that answers a state when the simulator says that it is its turn, and follows the other one else.

    With what became of the command of a period the simulator says on ``accepted_command`` which of the two answers the
    next state; a state is answered when that is known of the period before it. So there is one of them that acts,
    whichever of them was stopped, slow or restarted meanwhile.

    Standing by, its law answers every state to which an answer was accepted, and publishes nothing: its memory is that
    of the law which acts, and the command that it takes over with is the one which that law would have sent. Where it
    cannot know that - it was started in the run, it missed a state, or it lost its turn before - the law is reset when
    it takes over, which is an event as every reset.

    Args:
        make_law: see ControllerNode.
        joint_names: likewise.
        period: control period [ns].
        options: see ControllerNode.
    """

    def __init__(
        self, make_law: Callable[[], Law], joint_names: tuple[str, ...], *, period: int, **options: Any
    ) -> None:
        super().__init__(make_law, joint_names, paced=True, **options)
        self._period, self._codec = period, AcceptedCodec()
        self._forget()
        self.listen(ACCEPTED_COMMAND, self._on_accepted)
        self.keep()

    def configure(self) -> None:
        """Build the law, which knows of no state before."""
        super().configure()
        self._alike = self._newest_turn.stamp < 0

    def activate(self) -> None:
        """Answer the newest state, where it is its turn."""
        # Whether the law has to be reset is decided by the turns.
        self._passed_by = False
        super().activate()
        self._go_on()

    def begin_again(self) -> None:
        """Turns, too, begin again."""
        super().begin_again()
        self._forget()
        if self.configured:
            self._law.reset()

    def _forget(self) -> None:
        self._states: dict[int, Inputs] = {}
        self._followed: deque[Accepted] = deque()
        self._newest_turn = Accepted(-self._period, None, acting=CONTROLLERS[0])
        # How many states have an answer in the log, and how many this law has answered: the same ones, where alike.
        self._answered = self._answers = 0
        self._alike, self._acting = True, False
        self._mine: set[int] = set()
        self._last_stamp = -1

    def _on_accepted(self, raw: bytes) -> None:
        try:
            said = self._codec.decode(raw)
        except SpaceRobotError as error:
            self.refuse(ACCEPTED_COMMAND, error)
            return
        if not said.acting:
            return
        self._answered = said.answered
        if said.command is not None:
            if said.stamp in self._mine:
                self._mine.discard(said.stamp)
            else:
                self._followed.append(said)
        if said.stamp >= self._newest_turn.stamp:
            self._newest_turn = said
        self._go_on()

    def _take_in(self, state: RobotState, reference: Reference, beside: tuple[bytes, ...]) -> None:
        self._states[state.stamp] = state, reference, beside
        if len(self._states) > KEPT:
            del self._states[min(self._states)]
        self._go_on()

    def _go_on(self) -> None:
        """Follow what was answered, then answer, as far as it is known what there is and whose turn it is."""
        if not self.active or self.end_reason is not None:
            return
        while self._followed and self._followed[0].stamp in self._states:
            self._follow(self._followed.popleft())
        mine = self._newest_turn.acting == self.get_name()
        if not mine and self._acting:
            self.get_logger().warning(f"{self._newest_turn.acting} takes over")
            self._acting = self._alike = False
            self._waiting = None
        newest = max(self._states, default=-1)
        if self._may_answer(newest):
            super()._take_in(*self._states[newest])

    def _may_answer(self, stamp: int) -> bool:
        """Whether it is known what became of the period before, and that it is the turn of this node."""
        turn = self._newest_turn
        return stamp > self._last_stamp and turn.stamp >= stamp - self._period and turn.acting == self.get_name()

    def _answer(self, state: RobotState, reference: Reference, beside: tuple[bytes, ...]) -> None:
        self._waiting = None
        if not self._may_answer(state.stamp):
            return
        if not self._acting:
            self._take_turn(state.stamp)
        self._answers += 1
        self._mine.add(state.stamp)
        super()._answer(state, reference, beside)

    def _take_turn(self, stamp: int) -> None:
        self._acting, answered = True, self._answered
        if answered or self._answers:
            known = self._alike and self._answers == answered and not self._followed
            how = "as it was" if known else "begins again"
            self.get_logger().warning(f"takes over at {stamp} ns; what the law remembers {how}")
            if not known:
                self._law.reset_in_run()
        self._followed.clear()
        self._answers, self._alike = answered, True

    def _follow(self, said: Accepted) -> None:
        """Let the law answer a state that the other controller answered, and keep the answer to itself."""
        state, reference, beside = self._states[said.stamp]
        # A law that was started in the run, or has missed a state, cannot know what it should.
        self._alike = self._alike and self._answers + 1 == said.answered and said.stamp > self._last_stamp
        if not self._alike:
            return
        for raw in beside:
            cast(SupervisedController, self._law).supervise(self._modes.decode(raw))
        try:
            self._law.update(state, reference)
        except SpaceRobotError:
            # As it failed there: the run ends.
            self._alike = False
        self._answers, self._last_stamp = self._answers + 1, said.stamp
