"""Evaluations: side by side they have the numbers that each has alone, also where one of them fails."""

from __future__ import annotations

from typing import Any

import pytest

from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_studies.engine.tasks import Task
from space_robot_studies.tune import candidate
from space_robot_studies.tune.candidate import GROUPING, Judge, evaluate
from space_robot_studies.tune.spec import Objective

JUDGE = Judge(Objective(minimise={"joint_error": 1.0}), {}, ("joint1", "joint2", "joint3", "joint4"), (), 4.0)


def task(law: str, **changes: Any) -> Task[list[dict[str, Any]]]:
    """Two draws of a short move."""
    experiments = []
    for mass in (0.9, 1.1):
        moves = ["duration=4.0", "reference.duration=2.0", f"plant.payload.mass={mass}"]
        data = load_experiment("compare/mini", [*moves, f"controller={{law: {law}}}"]).model_dump(mode="json")
        data["controller"]["gains"] = changes
        experiments.append(data)
    return Task(f"{law} {changes}", evaluate, (experiments, JUDGE))


def test_evaluations_side_by_side_have_the_numbers_of_each_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """Gains that are tried together share one call; gains that are refused are refused in the same words."""
    tasks = [task("lqr", base_error=0.05), task("lqr", base_error=0.2), task("lqr", base_error=-1.0)]
    alone = [one.function(*one.arguments) for one in tasks]
    called: list[int] = []
    run_cases = candidate.run_cases

    def counted(cases: Any) -> Any:
        called.append(len(cases))
        return run_cases(cases)

    monkeypatch.setattr(candidate, "run_cases", counted)
    assert GROUPING.function([one.arguments for one in tasks]) == alone
    assert called == [6]
    assert [draws[0]["end_reason"] for draws in alone[:2]] == ["completed", "completed"]
    assert alone[0] != alone[1]
    assert "base_error" in alone[2][0]["end_reason"]


def test_evaluations_of_other_laws_or_tasks_share_no_call() -> None:
    """Laws without a compiled form are evaluated one by one."""
    assert GROUPING.kind(task("lqr")) == GROUPING.kind(task("lqr", time=3.0)) != GROUPING.kind(task("pd"))
    assert GROUPING.kind(task("tests.support.laws:Buggy")) is None
