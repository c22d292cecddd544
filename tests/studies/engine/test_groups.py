"""Runs that share a call of a worker: every one has exactly one outcome, that of the run alone."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator, Sequence
from typing import Any

import pytest

from space_robot_studies.engine.groups import LARGE, MANY, Grouping, run_in_groups, size_of
from space_robot_studies.engine.tasks import Lost, Result, Stop, Task


class Here:
    """Workers that do their tasks here, one after the other; those whose function says so are lost."""

    def __init__(self) -> None:
        self.calls: list[tuple[Any, int]] = []

    def run(self, tasks: Iterable[Task[Result]], stop: Stop) -> Iterator[tuple[Task[Result], Result | Lost]]:
        for task in tasks:
            if stop() is not None:
                return
            self.calls.append((task.key, task.runs))
            try:
                outcome: Any = task.function(*task.arguments)
            except ProcessLookupError:
                outcome = Lost("lost: the worker process was killed by SIGKILL")
            yield task, outcome


def square(number: int) -> int:
    return number * number


def squares(numbers: Sequence[tuple[int]]) -> list[int | None]:
    """Of the thirteenth only ``square`` can tell."""
    return [None if number == 13 else square(number) for (number,) in numbers]


def killed(numbers: Sequence[tuple[int]]) -> list[int | None]:
    raise ProcessLookupError


def parity(task: Task[int]) -> Hashable | None:
    """Odd and even ones; zero and every seventh is alone."""
    return task.arguments[0] % 2 + 1 if task.arguments[0] % 7 else None


@pytest.mark.parametrize("count", [0, 1, 2, 8, 5 * MANY + 3])
@pytest.mark.parametrize("together", [squares, killed])
def test_every_task_has_one_outcome_and_it_is_its_own(count: int, together: Any) -> None:
    """Full groups, rests, tasks alone, and those that a group has no result for, also because its worker was killed."""
    pool, tasks = Here(), [Task(k, square, (k,)) for k in range(count)]
    found = list(run_in_groups(pool, tasks, count, Grouping(parity, together), lambda: None))
    assert sorted((int(task.key), outcome) for task, outcome in found) == [(k, k * k) for k in range(count)]
    assert {task.key: task.arguments for task, _ in found} == {k: (k,) for k in range(count)}
    assert all(1 <= runs <= LARGE for _, runs in pool.calls)
    if count > 2 * LARGE:
        assert max(runs for _, runs in pool.calls) == size_of(count)


def test_a_stop_leaves_what_is_not_done() -> None:
    """After a reason to stop neither groups nor the tasks that were to be done again are begun."""
    pool, said = Here(), iter([None, "enough", "enough"])
    tasks = [Task(2 * k, square, (2 * k,)) for k in range(1, 40)]
    assert list(run_in_groups(pool, tasks, len(tasks), Grouping(parity, killed), lambda: next(said))) == []
    assert len(pool.calls) == 1
