"""Schedule and sequences: every step once, at the first tick at or after its time."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from space_robot_msgs_py.interfaces import NANOSECONDS
from space_robot_supervisor.plan import SCHEDULE, Plan, Step
from space_robot_supervisor.table import SupervisionTable

PERIOD = NANOSECONDS // 4


def plan_of(schedule: list[dict[str, Any]] | None = None, **sequences: list[dict[str, Any]]) -> Plan:
    """A plan of a table with these."""
    modes: dict[str, Any] = {"NOMINAL": {}, "HOLD": {}, "SAFE": {}}
    data = {"modes": modes, "schedule": schedule or [], "sequences": sequences}
    return Plan(SupervisionTable.model_validate(data))


def due(plan: Plan, ticks: range) -> list[tuple[int, Step]]:
    """Every step with the tick at which it is due."""
    return [(tick, step) for tick in ticks for step in plan.due(tick * PERIOD)]


def tick_of(seconds: float) -> int:
    """The first tick at or after a time."""
    return int(np.ceil(round(seconds * NANOSECONDS) / PERIOD))


@pytest.mark.parametrize("seed", range(20))
def test_every_step_is_due_once_at_the_first_tick_after_its_time(seed: int) -> None:
    """Of the schedule from the start of the run, of a sequence from its start, but never at the tick of that."""
    rng = np.random.default_rng(seed)
    times, afters = (np.sort(rng.choice([0.0, 0.1, 0.25, 0.3, 1.0, 2.0, 3.5], 5)).tolist() for _ in range(2))
    commands = ["hold", "safe", "nominal", "hold", "safe"]
    schedule = [{"at": at, "do": do} for at, do in zip(times, commands, strict=True)]
    steps = [{"after": after, "do": do} for after, do in zip(afters, commands, strict=True)]
    plan, begun = plan_of(schedule, rest=steps), int(rng.integers(0, 5))
    assert not plan.idle
    early = due(plan, range(begun + 1))
    plan.start("rest", begun * PERIOD)
    assert (plan.running, plan.begun("rest")) == (("rest",), begun * PERIOD)
    found = [*early, *due(plan, range(begun, 40))]
    expected = [(tick_of(at), Step(do, "", SCHEDULE, False)) for at, do in zip(times, commands, strict=True)]
    assert [one for one in found if one[1].by == SCHEDULE] == expected
    ticks = [max(begun + 1, tick_of(begun / 4 + after)) for after in afters]
    expected = [(tick, Step(do, "", "rest", k == 4)) for k, (tick, do) in enumerate(zip(ticks, commands, strict=True))]
    assert [one for one in found if one[1].by == "rest"] == expected
    plan.stop("rest")
    assert plan.idle


def test_of_one_tick_the_schedule_comes_first_then_the_older_sequence() -> None:
    """A sequence that is started again is the youngest, and begins at its first step."""
    one, two = [{"after": 1.0, "do": "hold"}], [{"after": 0.5, "do": "safe"}]
    plan = plan_of([{"at": 1.0, "start": "two"}], one=one, two=two)
    plan.start("one", 0)
    plan.start("two", 2 * PERIOD)
    assert [(step.by, step.command, step.start) for step in plan.due(NANOSECONDS)] == [
        (SCHEDULE, "", "two"),
        ("one", "hold", ""),
        ("two", "safe", ""),
    ]
    plan.start("one", NANOSECONDS)
    assert plan.running == ("two", "one")
    assert [step.by for step in plan.due(2 * NANOSECONDS)] == ["one"]


def test_what_a_step_does_may_end_its_sequence() -> None:
    """Nothing more of a sequence comes that was stopped while its steps are gone through."""
    plan = plan_of(rest=[{"after": 0.0, "do": "hold"}, {"after": 0.0, "do": "safe"}])
    plan.start("rest", 0)
    found = []
    for step in plan.due(PERIOD):
        found.append(step.command)
        plan.stop("rest")
    assert found == ["hold"]
    plan.stop("rest")
    assert plan.idle


def test_a_reset_begins_with_the_schedule_and_without_sequences() -> None:
    """As at the start of a run."""
    plan = plan_of([{"at": 0.5, "do": "hold"}], rest=[{"after": 1.0, "do": "safe"}])
    plan.start("rest", 0)
    first = due(plan, range(10))
    assert [step.by for _, step in first] == [SCHEDULE, "rest"]
    plan.start("rest", 0)
    plan.reset()
    assert (plan.running, plan.idle) == ((), False)
    assert due(plan, range(10)) == first[:1]
    assert plan.idle
