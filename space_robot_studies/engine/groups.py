"""Runs that share one call of a worker, where they can: what becomes of each is as if each had a task of its own."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator
from dataclasses import dataclass
from typing import Any, Generic

from space_robot_studies.engine.tasks import Lost, Result, Stop, Task, Workers

# As many runs as the widest vectors have lanes, where there are many; as the usual ones have, where there are few.
MANY, LARGE, SMALL = 64, 8, 4


@dataclass(frozen=True, slots=True)
class Grouping(Generic[Result]):
    """How tasks are put together.

    Attributes:
        kind: the same of tasks that may share a call; None: this one is done alone.
        function: does a list of arguments of such tasks; a result is None where only a task alone can tell.
    """

    kind: Callable[[Task[Result]], Hashable | None]
    function: Callable[[list[tuple[Any, ...]]], list[Result | None]]


def size_of(count: int) -> int:
    """How many of that many tasks go together, so that every worker has some."""
    return LARGE if count >= MANY else SMALL


def run_in_groups(
    pool: Workers, tasks: Iterable[Task[Result]], count: int, grouping: Grouping[Result], stop: Stop
) -> Iterator[tuple[Task[Result], Result | Lost]]:
    """See ``Workers.run``; a task of a group that came to no result is done again, alone, after all others.

    Args:
        pool: of workers.
        tasks: taken as they are needed, some more of them for the groups.
        count: how many there are.
        grouping: of these tasks.
        stop: see ``Workers.run``.
    """
    members: dict[int | str, list[Task[Result]]] = {}
    alone: list[Task[Result]] = []
    for task, outcome in pool.run(_grouped(tasks, size_of(count), grouping, members), stop):
        group = members.pop(task.key, None)
        if group is None:
            yield task, outcome
        elif isinstance(outcome, Lost):
            alone += group
        else:
            for member, one in zip(group, outcome, strict=True):
                if one is None:
                    alone.append(member)
                else:
                    yield member, one
    if alone:
        yield from pool.run(alone, stop)


def _grouped(
    tasks: Iterable[Task[Result]], size: int, grouping: Grouping[Result], members: dict[int | str, list[Task[Result]]]
) -> Iterator[Task[Any]]:
    """Full groups as they fill, then what is left."""
    filling: dict[Hashable, list[Task[Result]]] = {}
    for task in tasks:
        kind = grouping.kind(task)
        if kind is None:
            yield task
            continue
        group = filling.setdefault(kind, [])
        group.append(task)
        if len(group) == size:
            yield _together(filling.pop(kind), grouping, members)
    for group in filling.values():
        yield _together(group, grouping, members)


def _together(
    group: list[Task[Result]], grouping: Grouping[Result], members: dict[int | str, list[Task[Result]]]
) -> Task[Any]:
    if len(group) == 1:
        return group[0]
    key = f"group of {group[0].key}"
    members[key] = group
    return Task(key, grouping.function, ([task.arguments for task in group],), len(group))
