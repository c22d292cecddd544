"""What a run of a manifest leaves: numbers, curves, and how it ended; as plain data, too, for a journal."""

from __future__ import annotations

import base64
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from space_robot_msgs_py.interfaces import Vector
from space_robot_studies.reproduce.manifest import Bounds
from space_robot_studies.reproduce.quantities import Quantity

# Metrics that every run has, also one that failed.
OUTCOMES = ("completed", "diverged")
# Wall time of one update of the law [us], of the groups of a timing table: of this machine, so only its order counts.
CYCLE_TIMES = ("cycle_time.mean", "cycle_time.median", "cycle_time.p99")
# Of numbers in a journal: every byte comes back.
FLOATS = "<f8"


@dataclass(frozen=True, eq=False, slots=True)
class RunData:
    """What came back from a run.

    Attributes:
        end_reason: ``completed``, or why not.
        broken: bounds of the plant itself that it violated.
        metrics: by name; empty where nothing could be judged.
        largest: the largest errors of attitude and joints [deg] and position [m].
        taken: what was taken of its signals; None where the window holds no tick.
        time: (K,) of the ticks that are drawn [s].
        curves: (K,) signals that are drawn, by name.
        warnings: what the law warned of before the run.
        bag: its log was kept.
        cycle_times: by the names of CYCLE_TIMES, where a figure has a timing table.
        lost: its worker or the time limit ended it, which says nothing about the law.
    """

    end_reason: str
    broken: tuple[str, ...] = ()
    metrics: dict[str, float | None] = field(default_factory=dict)
    largest: dict[str, float] = field(default_factory=dict)
    taken: dict[Quantity, float | None] = field(default_factory=dict)
    time: Vector = field(default_factory=lambda: np.empty(0))
    curves: dict[str, Vector] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    bag: bool = False
    cycle_times: dict[str, float] = field(default_factory=dict)
    lost: bool = False

    @property
    def completed(self) -> bool:
        """It ran to its end and the plant kept its own bounds; only then its numbers count."""
        return self.end_reason == "completed" and bool(self.metrics) and not self.broken

    def diverged(self, bounds: Bounds) -> bool:
        """It did not complete, or an error left the bounds."""
        return not self.completed or any(value > getattr(bounds, name) for name, value in self.largest.items())

    def number(self, quantity: Quantity, bounds: Bounds) -> float | None:
        """The number; None if this run has none, and of a run that did not complete only its outcome."""
        if quantity.metric == "completed":
            return float(self.completed)
        if quantity.metric == "diverged":
            return float(self.diverged(bounds))
        if not self.completed:
            return None
        if quantity.metric in CYCLE_TIMES:
            return self.cycle_times.get(quantity.metric)
        return self.metrics[quantity.metric] if quantity.metric else self.taken[quantity]

    def to_columns(self) -> dict[str, Any]:
        """Plain data that JSON can hold, to the last bit; cycle times are measured anew."""
        return {
            "end_reason": self.end_reason,
            "broken": list(self.broken),
            "metrics": _packed(self.metrics),
            "largest": _packed(self.largest),
            "taken": [[asdict(quantity), _text(value)] for quantity, value in self.taken.items()],
            "time": _bytes(self.time),
            "curves": {name: _bytes(curve) for name, curve in self.curves.items()},
            "warnings": list(self.warnings),
            "bag": self.bag,
            "lost": self.lost,
        }

    @classmethod
    def from_columns(cls, columns: Mapping[str, Any]) -> RunData:
        """What ``to_columns`` gave.

        Raises:
            KeyError: something is missing.
            ValueError: something is not what it gives.
        """
        return cls(
            end_reason=columns["end_reason"],
            broken=tuple(columns["broken"]),
            metrics={name: _number(text) for name, text in columns["metrics"].items()},
            largest={name: float(text) for name, text in columns["largest"].items()},
            taken={Quantity(**wanted): _number(text) for wanted, text in columns["taken"]},
            time=_vector(columns["time"]),
            curves={name: _vector(text) for name, text in columns["curves"].items()},
            warnings=tuple(columns["warnings"]),
            bag=columns["bag"],
            lost=columns["lost"],
        )


def _packed(numbers: Mapping[str, float | None]) -> dict[str, str | None]:
    return {name: _text(value) for name, value in numbers.items()}


def _text(value: float | None) -> str | None:
    """The shortest text that reads back as the same number; an overflow is a number, too."""
    return None if value is None else repr(float(value))


def _number(text: str | None) -> float | None:
    return None if text is None else float(text)


def _bytes(values: Vector) -> str:
    return base64.b64encode(np.asarray(values, dtype=FLOATS).tobytes()).decode()


def _vector(text: str) -> Vector:
    return np.frombuffer(base64.b64decode(text, validate=True), dtype=FLOATS).astype(float)
