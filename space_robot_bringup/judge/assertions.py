"""Expectations over time, events and modes, judged while the ticks of a run come in."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from space_robot_bringup.experiment.expectations import (
    EVENTS,
    MODE,
    AnyExpectation,
    Expectation,
    Occurrence,
    OverTime,
    Temporal,
)
from space_robot_bringup.experiment.experiment import Experiment
from space_robot_bringup.judge.check import Check
from space_robot_bringup.judge.happenings import entered, known_names, names_of
from space_robot_bringup.judge.signals import Rows, Signal, signals_of
from space_robot_bringup.judge.temporal import Watch, watch_of
from space_robot_bringup.judge.window import Clock, Finding, Now
from space_robot_bringup.judge.wording import pattern
from space_robot_description.robot import Robot
from space_robot_description.validation import nearest
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.events import DiagnosticEvent
from space_robot_sim.faults.plan import FaultPlan

NOT_RUN = Finding(None, "no tick was completed")


@dataclass(frozen=True, slots=True)
class _Assertion:
    """One expectation: of a signal if there is one, else of a mode, else of an event."""

    name: str
    subject: str
    spec: Temporal
    signal: Signal | None = None
    mode: bool = False

    @property
    def bound(self) -> tuple[float, bool]:
        """The bound of a signal, and whether the condition is to be above it."""
        assert isinstance(self.spec, OverTime)
        over = self.spec.never_above if self.spec.never_above is not None else self.spec.above
        under = self.spec.never_below if self.spec.never_below is not None else self.spec.below
        return (over, True) if over is not None else (float(under or 0.0), False)

    @property
    def wanted(self) -> str:
        """What is wanted in words."""
        if self.signal is None:
            return pattern(self.spec)
        bound, over = self.bound
        condition, words = f"{'above' if over else 'below'} {bound:g} {self.signal.unit}", pattern(self.spec)
        if words.startswith("never"):
            return f"never {condition}{words.removeprefix('never')}"
        return f"{condition} {words}"

    def check(self, found: Finding) -> Check:
        """The verdict on it."""
        holds, judged = bool(found.passed), found.passed is not None
        return Check(
            self.name, found.measured, self.wanted, holds, self.spec.id, found.reason, about="task", judged=judged
        )


class Assertions:
    """Takes the ticks of a run block by block, of any sizes, and says what became of each expectation.

    Args:
        expect: checked, see ``check_assertions``; bounds on metrics are left out.
        robot: the NOMINAL robot.
        experiment: that was run.
    """

    def __init__(self, expect: Mapping[str, AnyExpectation], robot: Robot, experiment: Experiment) -> None:
        self._clock = Clock(experiment.period, experiment.steps * experiment.period)
        self._assertions = list(_assertions(expect, signals_of(robot)))
        self._watches = [self._watch(one) for one in self._assertions]
        self._mode = "" if experiment.supervision is None else experiment.supervision.start
        self._coming: deque[DiagnosticEvent] = deque()
        self._started = False

    def add(self, stamps: npt.NDArray[np.int64], rows: Rows, events: Iterable[DiagnosticEvent]) -> None:
        """Take the next ticks.

        Args:
            stamps: (K,) [ns].
            rows: of these ticks.
            events: that happened up to the last of them and were not there before, in order.

        Raises:
            LayoutError: a block of the plant's telemetry is missing.
        """
        if not self._assertions:
            return
        self._coming.extend(events)
        self._started = True
        read = {one.subject: one.signal.read(rows).tolist() for one in self._assertions if one.signal is not None}
        for index, stamp in enumerate(stamps.tolist()):
            names = self._happened(stamp)
            for one, watch in zip(self._assertions, self._watches, strict=True):
                watch.step(self._now(one, stamp, names, read[one.subject][index] if one.signal else None))

    def checks(self) -> tuple[Check, ...]:
        """The verdict, one by one."""
        found = [watch.finish() if self._started else NOT_RUN for watch in self._watches]
        return tuple(one.check(finding) for one, finding in zip(self._assertions, found, strict=True))

    def _watch(self, one: _Assertion) -> Watch:
        return watch_of(one.spec, self._clock, highest=one.signal is None or one.bound[1])

    def _happened(self, stamp: int) -> Set[str]:
        names: set[str] = set()
        while self._coming and self._coming[0].stamp <= stamp:
            event = self._coming.popleft()
            names.update(names_of(event))
            self._mode = entered(event) or self._mode
        return names

    def _now(self, one: _Assertion, stamp: int, names: Set[str], value: float | None) -> Now:
        if one.signal is not None and value is not None:
            bound, over = one.bound
            holds = value > bound if over else value < bound
            return Now(stamp, holds, value, names, f"{value:.6g} {one.signal.unit}")
        if one.mode:
            holds = self._mode == one.subject
            said = f"mode {self._mode}"
        else:
            holds = one.subject in names
            said = "it happened" if holds else "it had not happened"
        return Now(stamp, holds != _inverted(one.spec), None, names, said)


def check_assertions(
    expect: Mapping[str, AnyExpectation],
    robot: Robot,
    experiment: Experiment,
    plan: FaultPlan | None,
    metrics: Sequence[str],
) -> None:
    """Refuse what is expected of signals, modes and events there will not be, before anything is run.

    Args:
        expect: what is expected.
        robot: the NOMINAL robot.
        experiment: that is to be run.
        plan: its faults.
        metrics: names of the numbers of the whole run.

    Raises:
        SpecError: with the nearest names.
    """
    signals, names = signals_of(robot), list(dict.fromkeys(known_names(experiment, plan)))
    modes = () if experiment.supervision is None else tuple(experiment.supervision.modes)
    for key, one in expect.items():
        _check_form(key, one, metrics, signals)
        if isinstance(one, Mapping):
            what, known = ("mode", modes) if key == MODE else ("event", names)
            for name in one:
                _check_known(name, known, what, f"expect.{key}.{name}")
    for assertion in _assertions(expect, signals):
        spec, where = assertion.spec, f"expect.{assertion.name}"
        if isinstance(spec, Occurrence) and not assertion.mode:
            _check_event(spec, where)
        for word, moment in (("after", spec.after), ("until", spec.until)):
            if isinstance(moment, str):
                _check_known(moment, names, "event", f"{where}.{word}", moment)


def _check_form(key: str, one: AnyExpectation, metrics: Sequence[str], signals: Mapping[str, Signal]) -> None:
    """A name of a metric has bounds, one of a signal conditions over time, and ``mode`` and ``events`` one per name."""
    where = f"expect.{key}"
    if key in (MODE, EVENTS):
        if not isinstance(one, Mapping):
            accepted = f"{{NAME: {{within: 5.0, after: EVENT}}}}, NAME being {'a mode' if key == MODE else 'an event'}"
            raise SpecError("has an entry per name", key=where, accepted=accepted)
    elif isinstance(one, Expectation):
        if key in signals:
            accepted = "never_above, never_below, or above or below with within, at_most, at_least or at_end"
            raise SpecError("is a number over time", key=where, accepted=accepted)
        _check_known(key, [*metrics, *signals], "metric", where)
    elif key in metrics:
        raise SpecError("is one number of the whole run", key=where, accepted="value, min or max")
    elif isinstance(one, Mapping) or key not in signals:
        _check_known(key if key not in signals else "", [*signals, MODE, EVENTS], "signal", where)


def _check_known(name: str, known: Sequence[str], what: str, key: str, value: str | None = None) -> None:
    if name not in known:
        accepted = nearest(name, known) or ", ".join(known) or f"an experiment with {what}s: faults or supervision"
        raise SpecError(f"no such {what}", key=key, value=value, accepted=accepted)


def _check_event(spec: Occurrence, key: str) -> None:
    """An event has no duration."""
    for word, said in (("always", spec.always), ("at_end", spec.at_end), ("for", spec.for_)):
        if said is not None:
            accepted = "never, within, at_most, at_least"
            raise SpecError("an event has no duration", key=f"{key}.{word}", value=said, accepted=accepted)


def _assertions(expect: Mapping[str, AnyExpectation], signals: Mapping[str, Signal]) -> Iterator[_Assertion]:
    for key, one in expect.items():
        if isinstance(one, Mapping):
            for name, said in one.items():
                specs = (said,) if isinstance(said, Occurrence) else said
                yield from (_Assertion(f"{key}.{name}", name, spec, mode=key == MODE) for spec in specs)
        elif not isinstance(one, Expectation):
            over_time = (one,) if isinstance(one, OverTime) else one
            yield from (_Assertion(key, key, spec, signals[key]) for spec in over_time)


def _inverted(spec: Temporal) -> bool:
    """Always is never not."""
    return isinstance(spec, Occurrence) and bool(spec.always)
