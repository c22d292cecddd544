"""Where a process has threads, its studies start from one nursery, and none knows anything of another."""

from __future__ import annotations

import json
import os
import signal
import socket
import sys
from pathlib import Path
from threading import Event, Thread
from typing import Any

import pytest

from space_robot_bringup.modes.nursery import nursery
from space_robot_studies.engine.local_workers import LocalWorkers
from space_robot_studies.engine.spawner import PRELOADED
from space_robot_studies.engine.tasks import Task
from tests.support.processes import descendants


def load(name: str) -> None:
    __import__(name)


def seen(module: str, variable: str) -> tuple[bool, str | None, str]:
    return module in sys.modules, os.environ.get(variable), os.getcwd()


def ask(pool: LocalWorkers, module: str, variable: str) -> Any:
    ((_, answer),) = pool.run([Task(1, seen, (module, variable))], lambda: None)
    return answer


@pytest.fixture(autouse=True)
def second_thread() -> Any:
    """This process has more than one, so that it is not forked itself."""
    over = Event()
    thread = Thread(target=over.wait)
    thread.start()
    yield
    over.set()
    thread.join()


def test_a_study_has_the_folder_and_environment_of_now_and_nothing_of_the_one_before(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What one study loads is not there in the next, which sees this process as it is; both come from one nursery."""
    first = nursery(PRELOADED)
    for folder in ("one", "two"):
        (tmp_path / folder).mkdir()
        monkeypatch.chdir(tmp_path / folder)
        monkeypatch.setenv("OF_NOW", folder)
        prepared = (load, ("wave",)) if folder == "one" else None
        with LocalWorkers(1, 60.0, prepared) as pool:
            assert ask(pool, "wave", "OF_NOW") == (folder == "one", folder, str(tmp_path / folder))
    assert nursery(PRELOADED) is first


def test_what_is_read_once_has_a_nursery_of_its_own(monkeypatch: pytest.MonkeyPatch) -> None:
    """A variable that numba reads as it is loaded is in force in the next study, and the old nursery is gone."""
    first = nursery(PRELOADED)
    monkeypatch.setenv("NUMBA_OF_NOW", "1")
    with LocalWorkers(1, 60.0) as pool:
        assert ask(pool, "wave", "NUMBA_OF_NOW")[1] == "1"
    assert nursery(PRELOADED) is not first
    assert not first.usable


def test_a_nursery_that_was_killed_costs_nothing_but_its_start() -> None:
    """Between two studies it may die; the next study has another one."""
    first = nursery(PRELOADED)
    with LocalWorkers(1, 60.0) as pool:
        ask(pool, "wave", "PATH")
    (pid,) = [pid for pid in descendants(os.getpid(), 1) if pid == first.pid]
    os.kill(pid, signal.SIGKILL)
    first.wait()
    with LocalWorkers(1, 60.0) as pool:
        assert ask(pool, "wave", "PATH")[1] == os.environ["PATH"]


def test_two_threads_get_their_own_answers(monkeypatch: pytest.MonkeyPatch) -> None:
    """A thread asks only when the answer to the one before is read; their pools work beside each other."""
    asked, most, send, read = list[int](), list[int](), socket.send_fds, json.loads

    def ask_slowly(*arguments: Any) -> int:
        asked.append(1)
        most.append(len(asked))
        sent = send(*arguments)
        Event().wait(0.05)
        return sent

    def answered(text: bytes) -> Any:
        asked.pop()
        return read(text)

    nursery(PRELOADED)
    monkeypatch.setattr(socket, "send_fds", ask_slowly)
    monkeypatch.setattr("space_robot_bringup.modes.nursery.loads", answered)
    found: list[Any] = []

    def study() -> None:
        with LocalWorkers(1, 60.0) as pool:
            found.append(ask(pool, "wave", "PATH")[1])

    threads = [Thread(target=study) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert (found, most) == ([os.environ["PATH"]] * 3, [1, 1, 1])
