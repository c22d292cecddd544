"""Several laws of which one is active; another takes over at a period boundary, bumpless."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from space_robot_control.command_delay import CommandDelay
from space_robot_control.laws.base import Blocks, Law, Review
from space_robot_control.laws.tunable import GAINS
from space_robot_control.tracking import error_blocks, tracking_errors
from space_robot_description.robot import Robot
from space_robot_description.validation import nearest
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import NANOSECONDS, Command, Reference, RobotState, Vector
from space_robot_msgs_py.parameters import ParameterRow

ACTIVE = "active_law"
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
        self.uses_command_delay = all(law.uses_command_delay for law in self._laws.values())
        self._line: CommandDelay[Law | None] = CommandDelay(robot.command_delay, none=None)
        for _, name in switches:
            self._check_name(name)
        self._switches, self._handover = tuple(switches), round(handover * NANOSECONDS)
        self.reset()

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
        self._labels: dict[str, dict[str, int]] | None = None
        self._last: Vector | None = None
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
        errors = error_blocks(tracking_errors(state, reference))
        if self._labels is None:
            self._labels = self._layouts(state, reference, set(errors))
        taking_over = self._switch(state.stamp)
        law = self._laws[self._active]
        output = law.control(state, reference)
        u = output.command.u
        if taking_over and self._last is not None:
            self._bump, self._since = self._last - u, state.stamp
        weight, command = self._weight(state.stamp), output.command
        if weight:
            u = u + weight * self._bump
            command = Command(state.stamp, u[:6], u[6:])
        acting, owner = self._line.acting(command, None if weight else law)
        for other in self._laws.values():
            other.note_applied(acting, own=other is owner)
        self._last = u
        shown = {label: block for label, block in output.telemetry.items() if label in self._labels[self._active]}
        return u, {
            **errors,
            ACTIVE: float(self._names.index(self._active)),
            "handover": weight,
            **self._blocks(self._labels, shown),
        }

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

    def _layouts(self, state: RobotState, reference: Reference, shared: set[str]) -> dict[str, dict[str, int]]:
        """Labels and sizes of what each law shows beside the shared errors."""
        found = {}
        for name, law in self._laws.items():
            telemetry = law.control(state, reference).telemetry
            law.reset()
            sizes = zip(telemetry.labels, telemetry.sizes, strict=True)
            found[name] = {label: size for label, size in sizes if label not in shared}
        return found

    def _blocks(self, labels: Mapping[str, Mapping[str, int]], shown: Blocks) -> Blocks:
        return {
            f"{name}.{label}": shown[label] if name == self._active else np.zeros(size)
            for name, sizes in labels.items()
            for label, size in sizes.items()
        }

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
