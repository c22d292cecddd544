"""Several laws of which one is active; another takes over at a period boundary, bumpless."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from space_robot_control.command_delay import CommandDelay
from space_robot_control.laws.base import Blocks, Law, Review
from space_robot_control.laws.common_layout import ACTIVE, CommonLayout
from space_robot_control.laws.tunable import GAINS
from space_robot_control.tracking import ERROR_FIELDS
from space_robot_description.robot import Robot
from space_robot_description.validation import nearest
from space_robot_msgs_py.errors import NonFiniteError, SpecError
from space_robot_msgs_py.interfaces import (
    NANOSECONDS,
    Command,
    ControlOutput,
    Reference,
    RobotState,
    Telemetry,
    Vector,
)
from space_robot_msgs_py.parameters import ParameterRow

STANDBY = "standby."


class Switching(Law):
    """u(k) = u_new(k) + w(k) (u(s-1) - u_new(s)), w falling linearly from 1 at the switch s to 0 after ``handover``.

    The first command of the new law is thus the last one of the law before, and from one period to the next the command
    changes by what the new law wants and by a share T/handover of the bump there would have been: the smallest largest
    step. A law that takes over starts as at the beginning of a run, but for what it learned of the robot, see
    ``Law.resume``. Every law sees the applied command (``Law.on_applied``), so that the estimator of the new one does
    not attribute the torque of the law before to the robot, and an idle one keeps count of the wheels' momentum.

    Telemetry, in one layout for the whole run: the errors every law has; active_law (index, 0 the first), handover (w),
    and everything else of each law as ``<name>.<label>``, 0 while the law is idle. For these labels every law computes
    once, at the first state.

    Args:
        robot: the NOMINAL robot.
        control_period: [s].
        laws: by name; the first one starts.
        switches: (stamp [ns], name) in order of time; each acts at the first state of that stamp or later.
        handover: how long w takes from 1 to 0 [s]; 0: a switch is a step.

    Raises:
        SpecError: fewer than two laws, or a switch to a law that is not there.

    Deviations from the paper: there is no paper, the fading bump is added. Bumpless transfer in general: Zaccarian
    and Teel, "A common framework for anti-windup, bumpless transfer and reliable designs", Automatica 38(10), 2002.
    """

    name = "switching"
    # Labels of numbers in the telemetry that a class derived from this one has beside those above.
    _mark_labels: tuple[str, ...] = ()

    def __init__(
        self,
        robot: Robot,
        control_period: float,
        laws: Mapping[str, Law],
        *,
        switches: Sequence[tuple[int, str]] = (),
        handover: float = 5.0,
    ) -> None:
        super().__init__(robot, control_period)
        if len(laws) < 2:
            raise SpecError("nothing to switch to", key="laws", value=list(laws), accepted="two laws or more")
        self._laws, self._names = dict(laws), tuple(laws)
        # Those whose answers are checked here; what overrides ``control`` is called as it is.
        self._plain = {name for name, law in laws.items() if type(law).control is Law.control}
        self._informed = [law for law in laws.values() if type(law).on_applied is not Law.on_applied]
        self.uses_command_delay = all(law.uses_command_delay for law in self._laws.values())
        self._line: CommandDelay[Law | None] = CommandDelay(robot.command_delay, none=None)
        for _, name in switches:
            self._check_name(name)
        self._switches, self._handover = tuple(switches), round(handover * NANOSECONDS)
        self.reset()

    @property
    def laws(self) -> Mapping[str, Law]:
        """The laws by name, the first one first."""
        return self._laws

    @property
    def active(self) -> str:
        """Name of the active law."""
        return self._active

    def reset(self) -> None:
        """Back to the first law; all laws are reset."""
        super().reset()
        for law in self._laws.values():
            law.reset()
        self._active, self._requested, self._due = self._names[0], "", 0
        self._share_wheels()
        self._shown: CommonLayout | None = None
        self._last: Command | None = None
        self._bump, self._since = np.zeros(6 + self.n), -self._handover
        self._line.reset()

    def switch_to(self, name: str) -> None:
        """Let that law take over at the next update.

        Raises:
            SpecError: there is no such law.
        """
        self._check_name(name)
        self._requested = name

    def next_in_turn(self) -> str:
        """Name of the law after the active one, in the order of the experiment; after the last comes the first."""
        return self._names[(self._names.index(self._active) + 1) % len(self._names)]

    def parameters(self) -> Iterator[ParameterRow]:
        """The active law and the gains of all laws; those of the ones in standby are ``standby.<name>.gains...``."""
        names = ", ".join(self._names)
        yield ParameterRow(ACTIVE, self._active, f"the law that answers: {names}", dynamic=True)
        for prefix, law in self._prefixed().items():
            for row in law.parameters():
                yield ParameterRow(f"{prefix}{row.name}", row.value, row.description, row.dynamic, row.lower, row.upper)

    def tune(self, changes: Mapping[str, object]) -> None:
        """Change gains of one law, or ``active_law``, from the next update on.

        Raises:
            SpecError: see ``Law.tune``; or the changes are for more than one law.
        """
        gains = dict(changes)
        target = gains.pop(ACTIVE, None)
        if target is not None:
            self._check_name(target)
        owners = {self._owner(key) for key in gains}
        if len(owners) > 1:
            raise SpecError("one law at a time", key=", ".join(gains))
        for prefix in owners:
            self._prefixed()[prefix].tune({key.removeprefix(prefix): value for key, value in gains.items()})
            self.add_parameters_event(gains)
        if target is not None:
            self.switch_to(str(target))

    def prepare(self) -> None:
        """Of all laws: the next one is needed at once."""
        for law in self._laws.values():
            law.prepare()

    def review(self, path: Sequence[Reference]) -> Review:
        """What each of the laws finds."""
        reviews = [law.review(path) for law in self._laws.values()]
        return Review(
            tuple(fact for review in reviews for fact in review.facts),
            tuple(warning for review in reviews for warning in review.warnings),
        )

    def health(self) -> Mapping[str, float]:
        """Of the active law."""
        return self._laws[self._active].health()

    def compute(self, state: RobotState, reference: Reference) -> tuple[Vector, Blocks]:
        """Return u and the telemetry listed at the class."""
        output = self.control(state, reference)
        return output.command.u, dict(output.telemetry.items())

    def control(self, state: RobotState, reference: Reference) -> ControlOutput:
        """Answer as the active law does; the others compute nothing. See ``Law.control``."""
        if self._shown is None:
            self._shown = self._find_layout(state, reference)
        taking_over = self._switch(state.stamp)
        law = self._laws[self._active]
        if self._active in self._plain:
            command, blocks = law.answer(state, reference)
        else:
            output = law.control(state, reference)
            command, blocks = output.command, dict(output.telemetry.items())
        if taking_over and self._last is not None:
            self._bump, self._since = self._last.u - command.u, state.stamp
        weight = self._weight(state.stamp)
        if weight:
            command = self._command(state.stamp, command.u + weight * self._bump)
        # What may fail comes before what is remembered.
        telemetry = self._telemetry(law, blocks, state, reference, weight)
        acting, owner = self._line.acting(command, None if weight else law)
        self.wheels.apply(acting.u, self.control_period)
        for other in self._informed:
            other.on_applied(acting, own=other is owner)
        self._last = command
        return ControlOutput(command, telemetry, self.pending_events(state.stamp))

    def _telemetry(self, law: Law, blocks: Blocks, state: RobotState, reference: Reference, weight: float) -> Telemetry:
        """All laws' telemetry in one layout; where it cannot be, the active law says why not."""
        assert self._shown is not None
        try:
            return self._shown.of(self._active, blocks, state, reference, (weight, *self._marks()))
        except (NonFiniteError, ValueError):
            law.telemetry_of(state.stamp, blocks)
            raise

    def _marks(self) -> tuple[float, ...]:
        """The numbers of ``_mark_labels`` at this state."""
        return ()

    def note_applied(self, command: Command, *, own: bool) -> None:
        """Nothing is left to do: ``control`` knows what acts, and has the laws take note of it."""

    def _switch(self, stamp: int) -> bool:
        """Follow the schedule, or a request, which has priority; True if another law takes over now."""
        target = self._active
        while self._due < len(self._switches) and self._switches[self._due][0] <= stamp:
            target = self._switches[self._due][1]
            self._due += 1
        target, self._requested = self._requested or target, ""
        if target == self._active:
            return False
        self.add_event("switch", {"from": self._active, "to": target})
        self._active = target
        self._laws[target].take_over()
        return True

    def _weight(self, stamp: int) -> float:
        passed = stamp - self._since
        return max(0.0, 1.0 - passed / self._handover) if self._handover else 0.0

    def _find_layout(self, state: RobotState, reference: Reference) -> CommonLayout:
        """Let every law compute once, for the labels and sizes of its telemetry."""
        found = {}
        for name, law in self._laws.items():
            found[name] = law.control(state, reference).telemetry
            law.reset()
        self._share_wheels()
        own = {name for name, law in self._laws.items() if ERROR_FIELDS.items() <= law.telemetry_fields.items()}
        return CommonLayout(found, own, self.n, self._mark_labels)

    def _share_wheels(self) -> None:
        """All count the same momentum: once is enough."""
        for law in self._laws.values():
            law.wheels = self.wheels

    def _prefixed(self) -> dict[str, Law]:
        """Each law under what stands before its ``gains.``."""
        return {f"{STANDBY}{name}." if i else "": law for i, (name, law) in enumerate(self._laws.items())}

    def _owner(self, key: str) -> str:
        """The prefix in a key."""
        prefix = key.partition(GAINS)[0]
        if prefix not in self._prefixed():
            accepted = ", ".join(f"{one}{GAINS}..." for one in self._prefixed())
            raise SpecError("there is no such number to change", key=f"controller.{key}", accepted=accepted)
        return prefix

    def _check_name(self, name: object) -> None:
        if not isinstance(name, str) or name not in self._laws:
            accepted = nearest(name, self._names) or ", ".join(self._names)
            raise SpecError("not among the laws of this run", key=ACTIVE, value=name, accepted=accepted)
