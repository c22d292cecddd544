"""What a tuning came to: the best gains of every law, how sure that is, and the files that say so."""

from __future__ import annotations

import csv
import io
import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from space_robot_bringup.experiment.dotted_keys import set_key
from space_robot_bringup.experiment.readable import dump_yaml
from space_robot_control.laws.gain_range import GainRange
from space_robot_description.frozen import plain
from space_robot_msgs_py.atomic_file import write_atomically
from space_robot_studies.compare.comparison import METRICS
from space_robot_studies.engine.storage import guarded
from space_robot_studies.reproduce.estimate import Estimate
from space_robot_studies.tune.ranking import Evaluation, pareto
from space_robot_studies.tune.spec import TunedLaw, Tuning

NUMBERS, TABLE, BEST = "tuning.json", "evaluations.csv", "best"
# Error against effort.
FRONT = ("joint_error", "torque_integral")
EDGE = 0.02


@dataclass(frozen=True, slots=True)
class StandResult:
    """What was found for a law at a point of the grid.

    Attributes:
        name: of the law in the tables.
        law: with the gains that stay.
        where: law and point in words.
        labels: key to label of what is varied.
        ranges: dotted name of a gain to its range.
        evaluations: of the search, the shipped gains first.
        best: of them.
        neighbours: the best gains with one of them changed, down and up, gain by gain; empty where the shipped ones
            are the best.
        held_out_shipped: the shipped gains on the draws that the search never saw.
        held_out_best: the best ones on them.
    """

    name: str
    law: TunedLaw
    where: str
    labels: Mapping[str, Any]
    ranges: Mapping[str, GainRange]
    evaluations: tuple[Evaluation, ...]
    best: Evaluation
    neighbours: tuple[Evaluation, ...]
    held_out_shipped: Evaluation
    held_out_best: Evaluation

    @property
    def overfitted(self) -> bool:
        """On the held-out draws the best gains are worse than on those of the search: intervals apart, or failures."""
        seen, unseen = self.best.estimate, self.held_out_best.estimate
        if seen is None or unseen is None or self.best.feasible != self.held_out_best.feasible:
            return self.best.feasible and not self.held_out_best.feasible
        return unseen.low > seen.high

    @property
    def at_the_edge(self) -> tuple[str, ...]:
        """Gains whose best value lies within ``EDGE`` of an end of its range: a wider one may hold a better value."""
        found = self.best.gains.items()
        return tuple(name for name, value in found if not EDGE < self.ranges[name].share(value) < 1.0 - EDGE)

    @property
    def controller(self) -> dict[str, Any]:
        """The section of an experiment with the best gains."""
        section = {"controller": {"law": self.law.law, "gains": plain(self.law.gains)}}
        for name, value in self.best.gains.items():
            set_key(section, f"controller.gains.{name}", value, f"ranges.{name}")
        return section

    @property
    def overrides(self) -> str:
        """The best gains as options of ``space-robot run``; empty where the shipped ones are the best."""
        return " ".join(f"--set controller.gains.{name}={value!r}" for name, value in self.best.gains.items())

    def convergence(self) -> list[float | None]:
        """The objective of the best feasible evaluation so far, evaluation by evaluation; None before there is one."""
        found: list[float | None] = []
        for one in self.evaluations:
            before, now = found[-1] if found else None, one.objective if one.feasible else None
            found.append(before if now is None else now if before is None else min(before, now))
        return found

    def sensitivity(self) -> dict[str, tuple[float | None, float | None]]:
        """Gain to the objective below and above the best value; None where a run did not complete."""
        values = [one.objective for one in self.neighbours]
        return {name: (values[2 * k], values[2 * k + 1]) for k, name in enumerate(self.ranges) if values}

    def to_dict(self) -> dict[str, Any]:
        """Plain data; nothing in it depends on the machine or on how many workers there were."""
        front = pareto(self.evaluations, *FRONT)
        return {
            "law": self.name,
            "point": dict(self.labels),
            "evaluations": len(self.evaluations),
            "best": self.best.number,
            "gains": dict(self.best.gains),
            "feasible": self.best.feasible,
            "shipped": _settings(self.evaluations[0], self.held_out_shipped),
            "tuned": _settings(self.best, self.held_out_best),
            "overfitted": self.overfitted,
            "at_the_edge": list(self.at_the_edge),
            "convergence": self.convergence(),
            "pareto": [{"number": one.number} | {name: one.mean(name) for name in FRONT} for one in front],
            "sensitivity": {name: list(ends) for name, ends in self.sensitivity().items()},
        }


@dataclass(frozen=True, slots=True)
class TuningResult:
    """What a tuning left behind.

    Attributes:
        directory: of rows, tables, best gains.
        end_reason: ``completed``, ``interrupted``, ``terminated`` or why it could not go on.
        done: evaluations that are done.
        total: all, at most.
        stands: one result per law and point; empty unless completed.
    """

    directory: Path
    end_reason: str
    done: int
    total: int
    stands: tuple[StandResult, ...] = ()

    @property
    def passed(self) -> bool:
        """It came to its end, and every law has gains that keep the constraints."""
        return self.end_reason == "completed" and all(stand.best.feasible for stand in self.stands)

    def to_dict(self) -> dict[str, Any]:
        """Plain data."""
        return {"end_reason": self.end_reason, "stands": [stand.to_dict() for stand in self.stands]}


def write_result(result: TuningResult, tuning: Tuning) -> None:
    """Numbers, table of all evaluations, and the best gains of every law as a section to paste.

    Raises:
        LogError: they cannot be written.
    """
    place = result.directory
    with guarded(place):
        write_atomically(place / NUMBERS, json.dumps(result.to_dict(), indent=1, allow_nan=False) + "\n")
        write_atomically(place / TABLE, table(result))
        (place / BEST).mkdir(exist_ok=True)
        for stand in result.stands:
            seen, unseen = stand.best.objective, stand.held_out_best.estimate
            head = f"# {stand.where}: objective {number(seen)} on {tuning.draws} draws, {estimate(unseen)} held out.\n"
            write_atomically(place / BEST / f"{slug(stand.where)}.yaml", head + dump_yaml(stand.controller))


def table(result: TuningResult) -> str:
    """All evaluations of all searches as CSV; gains that a law does not have are empty."""
    gains = sorted({name for stand in result.stands for name in stand.ranges})
    keys = list(dict.fromkeys(key for stand in result.stands for key in stand.labels))
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(["law", *keys, "evaluation", "objective", "feasible", "failed", "excess", *METRICS, *gains])
    for stand in result.stands:
        for one in stand.evaluations:
            fixed = [one.number, one.objective, int(one.feasible), one.failed, one.excess]
            values = [*fixed, *one.numbers().values(), *(one.gains.get(name) for name in gains)]
            labels = [stand.labels.get(key) for key in keys]
            writer.writerow(["" if value is None else value for value in [stand.name, *labels, *values]])
    return stream.getvalue()


def slug(text: str) -> str:
    """A file name of law and point."""
    return re.sub(r"[^A-Za-z0-9._-]+", "-", text).strip("-.") or "law"


def number(value: float | None) -> str:
    """An objective in words."""
    return "none" if value is None else f"{value:.4g}"


def estimate(value: Estimate | None) -> str:
    """A mean with its interval in words."""
    return "not all completed" if value is None else format(value, ".4g")


def _settings(seen: Evaluation, unseen: Evaluation) -> dict[str, Any]:
    """A setting on the draws of the search and on the others."""
    found = {"search": seen, "held_out": unseen}
    return {
        name: {"objective": one.objective, "failed": one.failed, "excess": one.excess, "runs": len(one.draws)}
        | {"mean": _interval(one.estimate)}
        | one.numbers()
        for name, one in found.items()
    }


def _interval(value: Estimate | None) -> list[float] | None:
    return None if value is None else [value.value, value.low, value.high]
