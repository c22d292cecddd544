"""One evaluation: gains tried on some draws of a task, and what came of each draw as plain numbers."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Any, TypeAlias

from space_robot_bringup.experiment.dotted_keys import set_key
from space_robot_description.frozen import plain
from space_robot_msgs_py.errors import SpecError
from space_robot_studies.campaign.cases import make_case
from space_robot_studies.campaign.kinds import kind_of_case
from space_robot_studies.campaign.run_case import Keep, run_case, run_cases
from space_robot_studies.campaign.spec import Campaign
from space_robot_studies.compare.comparison import METRICS, task_numbers
from space_robot_studies.engine.groups import Grouping
from space_robot_studies.engine.tasks import Task
from space_robot_studies.tune.spec import Objective, TunedLaw

# What came of each draw.
Draws: TypeAlias = list[dict[str, Any]]
# An axis that never settles counts as if it had settled so many durations of the run after its begin.
NEVER_SETTLED = 2.0


@dataclass(frozen=True, slots=True)
class Judge:
    """What is read of a run, and when it is good.

    Attributes:
        objective: weights of the sum.
        constraints: number of a run -> largest value.
        angles: names of the revolute joints.
        banded: axes that have to settle.
        duration: of a run [s].
    """

    objective: Objective
    constraints: Mapping[str, float]
    angles: tuple[str, ...]
    banded: tuple[str, ...]
    duration: float

    def check(self, metrics: Sequence[str]) -> None:
        """Refuse names of numbers that no run has.

        Args:
            metrics: names of the numbers of a run.

        Raises:
            SpecError: an unknown one, or a settling time without bands.
        """
        named = [("objective.minimise", self.objective.minimise), ("constraints", self.constraints)]
        for section, numbers in named:
            for name in numbers:
                if name not in METRICS and name not in metrics:
                    accepted = f"{', '.join(METRICS)}, or a metric of a run such as {metrics[0]}"
                    raise SpecError("no such number", key=f"{section}.{name}", value=name, accepted=accepted)
                if name == "settling_time" and not self.banded:
                    accepted = "settling_bands in the experiment"
                    raise SpecError("is of no axis", key=f"{section}.{name}", accepted=accepted)

    def read(self, row: Mapping[str, Any]) -> dict[str, Any]:
        """What is kept of a run: its end, ``METRICS``, the objective, and by how much a constraint is missed.

        Args:
            row: columns of a case.

        Returns:
            ``objective`` is None where the run did not complete; ``excess`` sums (value - most) / most [-].
        """
        if not row["completed"]:
            return {"end_reason": row["end_reason"], "objective": None, "excess": None}
        numbers = task_numbers(row, self.angles, self.banded)
        terms = [weight * self._value(name, numbers, row) for name, weight in self.objective.minimise.items()]
        missed = [max(0.0, self._value(name, numbers, row) / most - 1.0) for name, most in self.constraints.items()]
        if not isfinite(sum(terms) + sum(missed)):
            return {"end_reason": "error: the objective is not finite", "objective": None, "excess": None}
        return {"end_reason": "completed", "objective": sum(terms), "excess": sum(missed), **numbers}

    def _value(self, name: str, numbers: Mapping[str, float | None], row: Mapping[str, Any]) -> float:
        value = numbers[name] if name in numbers else row.get(name)
        return NEVER_SETTLED * self.duration if value is None else float(value)


def experiment_of(
    campaign: Campaign, point: int, draw: int, law: TunedLaw, gains: Mapping[str, float]
) -> dict[str, Any]:
    """The experiment of one draw under a law with some of its gains changed; not yet checked.

    Args:
        campaign: the task.
        point: of its grid.
        draw: number of it.
        law: with the gains that stay.
        gains: dotted name to value.

    Raises:
        SpecError: a name leads nowhere.
    """
    data = dict(make_case(campaign, draw * campaign.points + point).data)
    data["controller"] = {"law": law.law, "gains": plain(law.gains)}
    for name, value in gains.items():
        set_key(data, f"controller.gains.{name}", value, f"ranges.{name}")
    return data


def evaluate(experiments: Sequence[Mapping[str, Any]], judge: Judge) -> Draws:
    """Run each draw headless and read it; whatever goes wrong in a run is its result."""
    (found,) = _evaluated([(experiments, judge)])
    return found


def evaluate_together(evaluations: list[tuple[Any, ...]]) -> list[Draws | None]:
    """``evaluate`` of several, whose runs go side by side where they can: each has the numbers that it has alone."""
    return [*_evaluated(evaluations)]


def kind_of(task: Task[Draws]) -> Hashable | None:
    """The same of evaluations whose runs may share a call."""
    experiments, _ = task.arguments
    return kind_of_case(experiments[0])


GROUPING: Grouping[Draws] = Grouping(kind_of, evaluate_together)


def _evaluated(evaluations: Sequence[tuple[Any, ...]]) -> list[Draws]:
    cases: list[tuple[Mapping[str, Any], str, Keep]] = [
        (data, "tuned", "none") for experiments, _ in evaluations for data in experiments
    ]
    together = run_cases(cases) if len(cases) > 1 and kind_of_case(cases[0][0]) else [None for _ in cases]
    results = iter([run_case(*case) if one is None else one for one, case in zip(together, cases, strict=True)])
    return [[judge.read(next(results).columns) for _ in experiments] for experiments, judge in evaluations]
