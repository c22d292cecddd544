"""Workers give results in order, with one thread each, and the caller's environment stays as it was."""

from __future__ import annotations

import os

import pytest

from space_robot_msgs_py.errors import SpaceRobotError, SpecError
from space_robot_studies.reproduce.process_pool import THREAD_VARIABLES, Workers


def environment(name: str) -> str | None:
    return os.environ.get(name)


def refuse(value: int) -> int:
    raise SpecError("not accepted", key="key", value=value, accepted="nothing")


def test_results_come_in_the_order_of_the_tasks() -> None:
    """Whoever is first done, results stand where their tasks stood; more tasks than workers are no problem."""
    seen: list[int] = []
    with Workers(2, lambda: None) as pool:
        assert pool.run([(pow, (2, power)) for power in range(20)], seen.append) == [2**power for power in range(20)]
        assert pool.run([(abs, (-1,))], seen.append) == [1]
    assert seen[-2:] == [20, 1]


def test_numeric_libraries_get_one_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    """Workers see one thread; the parent's variables are as they were."""
    monkeypatch.setenv(THREAD_VARIABLES[0], "7")
    monkeypatch.delenv(THREAD_VARIABLES[1], raising=False)
    with Workers(1, lambda: None) as pool:
        assert pool.run([(environment, (name,)) for name in THREAD_VARIABLES], lambda done: None) == ["1"] * 3
    assert environment(THREAD_VARIABLES[0]) == "7"
    assert environment(THREAD_VARIABLES[1]) is None


def test_an_error_of_a_task_arrives_whole() -> None:
    """What a worker raises is raised here, message, key and all."""
    with Workers(1, lambda: None) as pool, pytest.raises(SpecError, match="key: not accepted; got 3") as refusal:
        pool.run([(refuse, (3,))], lambda done: None)
    assert refusal.value.key == "key"


def test_a_worker_that_dies_is_one_clear_error() -> None:
    """A killed process ends the work with an error, not with a wait for ever."""
    with Workers(1, lambda: None) as pool:
        for _ in range(2):
            with pytest.raises(SpaceRobotError, match="a worker process died"):
                pool.run([(os._exit, (3,))], lambda done: None)


def test_a_reason_to_stop_ends_the_work() -> None:
    """Tasks that have not begun are not begun, and there is no result."""
    with Workers(1, lambda: "interrupted") as pool:
        assert pool.run([(pow, (2, power)) for power in range(50)], lambda done: None) is None
