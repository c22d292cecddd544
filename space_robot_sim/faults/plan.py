"""The faults of one run as a plan over its ticks: who acts when, and the events of the truth."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from decimal import Decimal
from typing import TypeVar

import numpy as np

from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.events import ERROR, OK, DiagnosticEvent
from space_robot_msgs_py.interfaces import NANOSECONDS
from space_robot_sim.faults.base import Fault, FaultSite, said

BEGINS, ENDS = "begins", "ends"
F = TypeVar("F", bound=Fault)


@dataclass(frozen=True, slots=True)
class PlannedFault:
    """A fault with its window.

    Attributes:
        fault: what happens.
        index: its place in the list of the experiment.
        label: what its events are called; no other fault of the run has it.
        first: tick from which it acts.
        end: tick from which it does not; behind the run where it stays.
    """

    fault: Fault
    index: int
    label: str
    first: int
    end: int

    def acts(self, tick: int) -> bool:
        """It acts in the period that begins at this tick."""
        return self.first <= tick < self.end


@dataclass(frozen=True, slots=True)
class FaultPlan:
    """Everything that goes wrong in a run; a function of the tick.

    Attributes:
        planned: the faults, in the order of the experiment.
        period: control period [ns].
        seed: of everything random in them.
    """

    planned: tuple[PlannedFault, ...]
    period: int
    seed: int

    def of(self, kind: type[F]) -> tuple[PlannedFault, ...]:
        """The faults of a class of faults."""
        return tuple(one for one in self.planned if isinstance(one.fault, kind))

    def events(self, tick: int) -> tuple[DiagnosticEvent, ...]:
        """What begins and ends at a tick: ends first, each in the order of the experiment."""
        ended = [_event(one, tick * self.period, OK) for one in self.planned if one.end == tick]
        return (*ended, *(_event(one, tick * self.period, ERROR) for one in self.planned if one.first == tick))

    def window(self, one: PlannedFault) -> str:
        """When a fault acts, in words."""
        begin, end = (tick * self.period / NANOSECONDS for tick in (one.first, one.end))
        return f"from {begin:g} s {'on' if one.fault.for_ is None else f'to {end:g} s'}"

    def rng(self, one: PlannedFault, tick: int) -> np.random.Generator:
        """The generator of a fault at a tick: it depends on nothing that happened before."""
        return np.random.default_rng(np.random.SeedSequence(self.seed, spawn_key=(one.index, tick)))


def plan_faults(faults: Sequence[Fault], site: FaultSite, *, period: int, steps: int, seed: int) -> FaultPlan:
    """Check the faults of an experiment and place them on its ticks.

    Args:
        faults: as the experiment says them.
        site: the robot they happen to.
        period: control period [ns].
        steps: of the run.
        seed: of everything random in them.

    Raises:
        SpecError: the robot has no such part, or a window is not within the run.
    """
    labels = _labels(faults)
    planned = []
    for index, (fault, label) in enumerate(zip(faults, labels, strict=True)):
        key = f"faults.{index}"
        fault.check(site, key)
        first, end = _window(fault, key, period, steps)
        planned.append(PlannedFault(fault, index, label, first, end))
    return FaultPlan(tuple(planned), period, seed)


def _window(fault: Fault, key: str, period: int, steps: int) -> tuple[int, int]:
    """First tick and the tick behind the last."""
    duration, seconds = steps * period, period / NANOSECONDS
    first = _tick(fault.at, period)
    if first >= steps:
        accepted = f"before the last period, which begins at {(duration - period) / NANOSECONDS:g} s"
        raise SpecError("is not within the run", key=f"{key}.at", value=fault.at, accepted=accepted)
    if fault.for_ is None:
        return first, steps + 1
    end = _tick(fault.at + fault.for_, period)
    if end > steps:
        accepted = f"up to {duration / NANOSECONDS - fault.at:g} s, or nothing: to the end of the run"
        raise SpecError("goes beyond the run", key=f"{key}.for", value=fault.for_, accepted=accepted)
    if end == first:
        accepted = f"at least a control period, {seconds:g} s"
        raise SpecError("no tick is within it", key=f"{key}.for", value=fault.for_, accepted=accepted)
    return first, end


def _tick(seconds: float, period: int) -> int:
    """The first tick at or after a time; what is within a picosecond of a tick is at it."""
    exact = Decimal(repr(round(seconds, 12))) * NANOSECONDS / period
    return int(exact.to_integral_value(rounding="ROUND_CEILING"))


def _labels(faults: Sequence[Fault]) -> Iterator[str]:
    """A name for each that no other has."""
    names = [fault.name or " ".join(filter(None, (fault.kind, fault.place))) for fault in faults]
    seen, several = Counter[str](), Counter(names)
    for name in names:
        seen[name] += 1
        yield f"{name} #{seen[name]}" if several[name] > 1 else name


def _event(one: PlannedFault, stamp: int, level: int) -> DiagnosticEvent:
    fault = one.fault
    values = tuple((key, value if isinstance(value, str) else json.dumps(value)) for key, value in said(fault).items())
    message = BEGINS if level == ERROR else ENDS
    return DiagnosticEvent(stamp, level, one.label, message, fault.place, (("kind", fault.kind), *values))
