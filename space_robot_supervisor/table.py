"""The table of a supervisor: modes and monitors, checked before anything runs."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from pydantic import Field, NonNegativeFloat, SerializerFunctionWrapHandler, model_serializer

from space_robot_description.spec import Strict, Title
from space_robot_description.validation import nearest
from space_robot_msgs_py.errors import SpecError
from space_robot_supervisor.rows import (
    COMMANDS,
    CONTROLLER,
    LATER,
    RESERVED,
    HousekeepingSpec,
    ModeSpec,
    MonitorSpec,
    Name,
    ScheduleStep,
    SequenceStep,
    said,
)


class SupervisionTable(Strict):
    """Modes and monitors of a supervisor."""

    title: Title = ""
    start: Name = Field(default="NOMINAL", description="mode in which a run begins")
    handover: NonNegativeFloat = Field(
        default=0.0, description="how long the last command of the law before fades out when a mode brings another [s]"
    )
    modes: dict[Name, ModeSpec] = Field(min_length=1)
    fallback: Name | None = Field(
        default=None,
        description="mode whose law answers a state to which the law of the experiment has no answer, which is then "
        "reset; null: the run ends",
    )
    monitors: tuple[MonitorSpec, ...] = Field(default=(), max_length=1_000)
    schedule: tuple[ScheduleStep, ...] = Field(
        default=(), max_length=1_000, description="what is done when, in the order of time"
    )
    sequences: dict[Name, tuple[SequenceStep, ...]] = Field(
        default_factory=dict, description="steps that a monitor or the schedule may start, in the order of time"
    )
    housekeeping: HousekeepingSpec | None = Field(default=None, description="null: none")

    @model_serializer(mode="wrap")
    def _without_what_is_not(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        return said(handler(self), LATER)

    def check(self, key: str) -> None:
        """Refuse what contradicts itself.

        Args:
            key: of the table, for errors.

        Raises:
            SpecError: a mode that is not there or is never reached, a name twice, transitions that contradict.
        """
        self._check_mode(self.start, f"{key}.start")
        self._check_fallback(f"{key}.fallback")
        names = [row.name for row in self.monitors]
        for index, row in enumerate(self.monitors):
            place = f"{key}.monitors.{index}"
            if row.name in RESERVED:
                raise SpecError("is the name of other events", key=f"{place}.name", value=row.name)
            if row.name in names[:index]:
                raise SpecError("there is one of that name", key=f"{place}.name", value=row.name)
            for mode in row.in_:
                self._check_mode(mode, f"{place}.in")
            if row.to is not None:
                self._check_mode(row.to, f"{place}.to")
                if row.to in row.in_:
                    accepted = "modes from which it leads somewhere else"
                    raise SpecError(
                        "leads to a mode it is looked at in", key=f"{place}.in", value=row.to, accepted=accepted
                    )
        for first, second in self._pairs():
            self._check_pair(first, second, key)
        self._check_steps(key)
        self._check_reachable(key)

    @property
    def brakes(self) -> bool:
        """Some mode closes the brakes of the joints."""
        return any(mode.brakes for mode in self.modes.values())

    @property
    def unloads(self) -> bool:
        """Thrusters unload the wheels in some mode."""
        return any(mode.unload for mode in self.modes.values())

    def modes_of(self, row: MonitorSpec) -> tuple[str, ...]:
        """In which modes a row is looked at."""
        return row.in_ or tuple(mode for mode in self.modes if mode != row.to)

    def _check_fallback(self, key: str) -> None:
        if self.fallback is None:
            return
        self._check_mode(self.fallback, key)
        if self.modes[self.fallback].law == CONTROLLER:
            accepted = "a mode with a law of its own"
            raise SpecError("has the law that fails", key=key, value=self.fallback, accepted=accepted)

    def _check_steps(self, key: str) -> None:
        for name, mode in self.modes.items():
            for one in mode.from_:
                self._check_mode(one, f"{key}.modes.{name}.from")
        for place, name in self._started():
            if name not in self.sequences:
                accepted = nearest(name, self.sequences) or ", ".join(self.sequences) or "a section sequences"
                raise SpecError("no such sequence", key=f"{key}.{place}", value=name, accepted=accepted)
        plans = {"schedule": [(step.at, step.do) for step in self.schedule]}
        plans |= {
            f"sequences.{name}": [(step.after, step.do) for step in steps] for name, steps in self.sequences.items()
        }
        for place, steps in plans.items():
            for index, (time, command) in enumerate(steps):
                if index and time < steps[index - 1][0]:
                    raise SpecError("before the step above", key=f"{key}.{place}.{index}", value=time)
                if command is not None:
                    self._check_mode(mode_of(command), f"{key}.{place}.{index}.do")

    def _started(self) -> Iterator[tuple[str, str]]:
        for index, row in enumerate(self.monitors):
            if row.start is not None:
                yield f"monitors.{index}.start", row.start
        for index, step in enumerate(self.schedule):
            if step.start is not None:
                yield f"schedule.{index}.start", step.start

    def _check_mode(self, mode: str, key: str) -> None:
        if mode not in self.modes:
            accepted = nearest(mode, self.modes) or ", ".join(self.modes)
            raise SpecError("no such mode", key=key, value=mode, accepted=accepted)

    def _pairs(self) -> Iterator[tuple[MonitorSpec, MonitorSpec]]:
        rows = [row for row in self.monitors if row.to is not None]
        return ((first, second) for index, first in enumerate(rows) for second in rows[index + 1 :])

    def _check_pair(self, first: MonitorSpec, second: MonitorSpec, key: str) -> None:
        """Two rows on one value must not say two things at once, nor lead to and fro."""
        if first.value != second.value or not _overlap(first, second):
            return
        together = set(self.modes_of(first)) & set(self.modes_of(second))
        if together and first.to != second.to and first.severity == second.severity:
            raise SpecError(
                f"contradicts {first.name!r}: in {min(together)} both may hold, and they lead to different modes",
                key=f"{key}.monitors",
                value=second.name,
                accepted="other bounds, modes or severities",
            )
        if second.to in self.modes_of(first) and first.to in self.modes_of(second):
            raise SpecError(
                f"leads back from where {first.name!r} leads to while its condition holds",
                key=f"{key}.monitors",
                value=second.name,
                accepted="bounds that do not overlap",
            )

    def _check_reachable(self, key: str) -> None:
        reached, news = {self.start}, {self.start}
        while news:
            news = {row.to for row in self.monitors if row.to and reached & set(self.modes_of(row))}
            # The ground may command what has the name of a command, from where the mode allows it.
            news |= {
                name
                for name, mode in self.modes.items()
                if name.lower() in COMMANDS and name.isupper() and (not mode.from_ or reached & set(mode.from_))
            }
            news -= reached
            reached |= news
        for mode in self.modes:
            if mode not in reached:
                accepted = "a monitor that leads to it, or no such mode"
                raise SpecError("is never reached", key=f"{key}.modes.{mode}", accepted=accepted)


def mode_of(command: str) -> str:
    """The mode that a command of the ground leads to."""
    return command.upper()


def _overlap(first: MonitorSpec, second: MonitorSpec) -> bool:
    """Some value fulfils both conditions."""
    if first.unchanged or second.unchanged:
        return first.unchanged and second.unchanged
    both_above = first.above is not None and second.above is not None
    both_below = first.below is not None and second.below is not None
    crossed = [(first.above, second.below), (second.above, first.below)]
    return both_above or both_below or any(a is not None and b is not None and a < b for a, b in crossed)
