"""One of two controllers of a paced run: one acts, the other one stands by, hot, and takes over when it is its turn."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Any, cast

from std_srvs.srv import Trigger

from space_robot_control.laws.base import Law
from space_robot_control.laws.common_layout import ACTIVE
from space_robot_control.laws.recorded_events import apply_event
from space_robot_control.nodes.controller import ControllerNode
from space_robot_msgs_py.codec.accepted import CONTROLLERS
from space_robot_msgs_py.codec.codecs import Accepted, AcceptedCodec
from space_robot_msgs_py.errors import SpaceRobotError, SpecError
from space_robot_msgs_py.interfaces import Reference, RobotState, SupervisedController
from space_robot_msgs_py.nodes.fill import fill
from space_robot_msgs_py.topics import ACCEPTED_COMMAND

# States that are kept until it is known what became of their commands; as many periods late a command may be.
KEPT = 128
Inputs = tuple[RobotState, Reference, tuple[bytes, ...]]


class RedundantControllerNode(ControllerNode):
    """A controller that answers a state when the simulator says that it is its turn, and follows the other one else.

    With what became of the command of a period the simulator says on ``accepted_command`` which of the two answers the
    next state; a state of a turn is answered when that is known of the period before it. So there is one of them that
    acts, whichever of them was stopped, slow or restarted meanwhile.

    Standing by, its law answers every state to which an answer was accepted, with the events of that answer, and
    publishes nothing: its memory is that of the law which acts, and the command that it takes over with is the one
    which that law would have sent. Where it cannot know that - it was started in the run, it missed a state, it lost
    its turn, or an answer of its own came too late - the law is reset before it answers again, which is an event as
    every reset. So what the law of the one that acts remembers is what the log says, in whatever order messages come.

    Gains are changed at the one that acts; the other one learns of it with the command that they act on first, and
    refuses to be changed itself.

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
        # The first state of the turn in which it answers; None: it stands by.
        self._began: int | None = None
        self._period, self._codec = period, AcceptedCodec()
        self._forget()
        self.listen(ACCEPTED_COMMAND, self._on_accepted)
        self.keep()

    def configure(self) -> None:
        """Build the law, which knows of no state before."""
        super().configure()
        self._alike = self._until < 0
        self._began = None

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

    def retune(self, changes: dict[str, Any]) -> None:
        """Change gains or the active law from the next state on, for both controllers.

        Raises:
            SpecError: the law does not accept it, or it is the turn of the other controller.
        """
        if not self._is_turn:
            accepted = f"a change at {self._turn.acting}, which acts and passes it on"
            raise SpecError("this controller stands by", key=", ".join(changes), accepted=accepted)
        super().retune(changes)

    def _forget(self) -> None:
        self._states: dict[int, Inputs] = {}
        self._followed: deque[Accepted] = deque()
        # What was heard last, and the newest period of which something was.
        self._turn, self._until = Accepted(-self._period, None, acting=CONTROLLERS[0]), -self._period
        self._began = None
        # How many states this law has answered: those in the log, in the same way, where alike.
        self._answers, self._alike = 0, True
        # It has heard of all changes of gains.
        self._informed = True
        self._mine: set[int] = set()
        self._last_stamp = -1

    @property
    def _is_turn(self) -> bool:
        return bool(self._turn.acting == self.get_name())

    def _on_accepted(self, raw: bytes) -> None:
        try:
            said = self._codec.decode(raw)
        except SpaceRobotError as error:
            self.refuse(ACCEPTED_COMMAND, error)
            return
        if not said.acting:
            return
        if said.stamp > self._until + self._period:
            # What was said of periods in between is lost.
            self._informed = self._alike = False
            self._lose_turn("what became of some answers is not known")
        self._turn, self._until = said, max(self._until, said.stamp)
        if said.command is not None:
            if said.stamp in self._mine:
                self._mine.discard(said.stamp)
            else:
                self._followed.append(said)
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
        self._alike = self._alike and len(self._followed) <= KEPT
        while self._followed and (not self._alike or self._followed[0].stamp in self._states):
            self._follow(self._followed.popleft())
        if not self._is_turn or self._turn.since != self._began:
            self._lose_turn("an answer came too late" if self._is_turn else f"{self._turn.acting} takes over")
        newest = max(self._states, default=-1)
        if self._may_answer(newest):
            super()._take_in(*self._states[newest])

    def _lose_turn(self, why: str) -> None:
        """What it answered last may not be in the log."""
        if self._began is not None:
            self.get_logger().warning(why)
            self._began, self._alike, self._waiting = None, False, None

    def _may_answer(self, stamp: int) -> bool:
        """Whether it is known what became of the period before, and that the state is one of its turn."""
        in_turn = self._is_turn and stamp >= self._turn.since
        return in_turn and stamp > self._last_stamp and self._until >= stamp - self._period

    def _answer(self, state: RobotState, reference: Reference, beside: tuple[bytes, ...]) -> None:
        self._waiting = None
        if not self._may_answer(state.stamp):
            return
        if self._began is None:
            self._take_turn(state.stamp)
        self._answers += 1
        self._mine.add(state.stamp)
        super()._answer(state, reference, beside)

    def _take_turn(self, stamp: int) -> None:
        self._began, answered = self._turn.since, self._turn.answered
        if answered or self._answers:
            known = self._alike and self._answers == answered and not self._followed
            how = "as it was" if known else "begins again"
            self.get_logger().warning(f"takes over at {stamp} ns; what the law remembers {how}")
            if not known:
                self._begin_law_again()
        self._answers, self._alike = answered, True

    def _begin_law_again(self) -> None:
        while self._followed:
            self._learn(self._followed.popleft())
        if not self._informed:
            # The log gets all of them: this law may have others than the one that acted.
            for row in self._law.parameters():
                if row.dynamic and row.name != ACTIVE:
                    self._law.tune({row.name: row.value})
            self._informed = True
        self._law.reset_in_run()

    def _follow(self, said: Accepted) -> None:
        """Let the law answer a state that the other controller answered, and keep the answer to itself."""
        # A law that was started in the run, or has missed a state, cannot know what it should, until there is a reset.
        again = any(event.kind == "reset" for event in said.events) and said.stamp in self._states
        follows = self._answers + 1 == said.answered and said.stamp > self._last_stamp
        self._alike = again or (self._alike and follows)
        self._learn(said)
        if not self._alike:
            return
        state, reference, beside = self._states[said.stamp]
        try:
            for raw in beside:
                cast(SupervisedController, self._law).supervise(self._modes.decode(raw))
            events = self._law.update(state, reference).events
            # Other gains of the other law would show here.
            self._alike = [one.line for one in events] == [one.line for one in said.events]
            self._informed = self._informed or (again and self._alike)
        except SpaceRobotError:
            # As it failed there: the run ends.
            self._alike = False
        self._answers, self._last_stamp = said.answered, said.stamp

    def _learn(self, said: Accepted) -> None:
        """Do to this law what the events of an answer say; where it does not follow, only its gains matter."""
        for event in said.events:
            if event.kind != "parameters" and not self._alike:
                continue
            try:
                if event.kind == "parameters":
                    super().retune(dict(event.content.get("values", {})))
                    self.parameters.declare(self._law.parameters())
                else:
                    apply_event(self._law, event)
                    self._show_active()
            except (SpaceRobotError, TypeError, ValueError) as error:
                self._alike = self._informed = False
                self.refuse(ACCEPTED_COMMAND, error)

    def _on_switch(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        if not self._is_turn:
            return fill(response, success=False, message=f"this controller stands by; {self._turn.acting} acts")
        return super()._on_switch(request, response)
