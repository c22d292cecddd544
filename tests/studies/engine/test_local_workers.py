"""Local workers do tasks, and a task can do no harm but to itself."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from threading import Event
from time import monotonic
from typing import Any

import pytest

from space_robot_bringup.modes.pinned import PINNED
from space_robot_msgs_py.errors import SilenceError, SpecError
from space_robot_studies.engine.local_workers import LocalWorkers, cpu_time
from space_robot_studies.engine.tasks import Lost, Task
from tests.support.paths import ROOT
from tests.support.processes import descendants

LIMIT = 60.0
HERE = "tests.studies.engine.test_local_workers"


def refuse(value: int) -> int:
    raise SpecError("not accepted", key="key", value=value, accepted="nothing")


def leave() -> None:
    sys.exit("enough")


def interrupt() -> None:
    raise KeyboardInterrupt


def kill(number: int) -> None:
    os.kill(os.getpid(), number)


def close_everything() -> None:
    os.closerange(3, 1000)
    Event().wait()


def wait() -> None:
    Event().wait()


def loop() -> None:
    while True:
        pass


def unsendable() -> Any:
    return lambda: None


def environment() -> dict[str, str | None]:
    return {name: os.environ.get(name) for name in PINNED}


def loaded(name: str) -> bool:
    return name in sys.modules


def load(name: str) -> None:
    __import__(name)


def never() -> None:
    return None


def all_of(pool: LocalWorkers, *tasks: Task[Any]) -> dict[Any, Any]:
    return {task.key: outcome for task, outcome in pool.run(tasks, never)}


@pytest.fixture(scope="module")
def pool() -> Iterator[LocalWorkers]:
    with LocalWorkers(2, LIMIT, (load, ("antigravity_is_not_there",))) as made:
        yield made


def test_every_task_is_done_once(pool: LocalWorkers) -> None:
    """More tasks than workers are no problem, workers are used again, and tasks are taken only when they are needed."""
    taken: list[int] = []

    def tasks() -> Iterator[Task[int]]:
        for power in range(30):
            taken.append(power)
            yield Task(power, pow, (2, power))

    seen, ahead = {}, []
    for task, outcome in pool.run(tasks(), never):
        seen[task.key] = outcome
        ahead.append(len(taken) - len(seen))
    assert seen == {power: 2**power for power in range(30)}
    assert max(ahead) <= 4
    assert set(all_of(pool, *(Task(k, os.getpid, ()) for k in range(8))).values()) <= set(descendants(os.getpid()))


@pytest.mark.parametrize(
    ("function", "arguments", "reason"),
    [
        (leave, (), "bug: SystemExit: enough"),
        (interrupt, (), "bug: KeyboardInterrupt"),
        (unsendable, (), "bug: the result cannot be sent"),
        (refuse, (3,), "lost: SpecError"),
        (os._exit, (3,), "lost: the worker process exited with status 3"),
        (os._exit, (0,), "lost: the worker process exited with status 0"),
        (kill, (signal.SIGKILL,), "lost: the worker process was killed by SIGKILL"),
        (kill, (signal.SIGSEGV,), "lost: the worker process was killed by SIGSEGV"),
        (close_everything, (), "lost: the worker process went away"),
    ],
)
def test_a_failing_task_costs_no_other_task(
    pool: LocalWorkers, function: Any, arguments: tuple[Any, ...], reason: str
) -> None:
    """Whatever a task raises, or does to its process, is its outcome; the tasks around it are done."""
    bad = Task("bad", function, arguments)
    found = all_of(pool, Task(1, abs, (-1,)), bad, Task(2, abs, (-2,)), Task(3, abs, (-3,)))
    assert isinstance(found["bad"], Lost)
    assert found["bad"].reason.startswith(reason)
    assert [found[key] for key in (1, 2, 3)] == [1, 2, 3]


def test_an_error_of_a_task_arrives_whole(pool: LocalWorkers) -> None:
    """What a task raises on purpose is in its outcome, message, key and all."""
    (outcome,) = all_of(pool, Task("refused", refuse, (3,))).values()
    assert str(outcome.error) == "key: not accepted; got 3; accepted: nothing"
    assert (outcome.error.key, outcome.error.value) == ("key", 3)


def test_numeric_libraries_get_one_thread(pool: LocalWorkers) -> None:
    """Workers see one thread, whatever the parent's variables say."""
    (seen,) = all_of(pool, Task("environment", environment, ())).values()
    assert seen == PINNED


def test_a_task_that_never_ends_is_ended() -> None:
    """CPU time is limited, and elapsed time ten times as far; the workers behind are replaced."""
    with LocalWorkers(2, 0.2) as pool:
        found = all_of(pool, Task("loops", loop, ()), Task("waits", wait, ()))
        assert found["loops"].reason == "timeout: more than 0.2 s of CPU time"
        assert found["waits"].reason == "timeout: more than 2 s, most of them waiting"
        assert found["loops"].time_limit == found["waits"].time_limit == 0.2
        assert all_of(pool, Task(1, abs, (-1,))) == {1: 1}


def test_a_reason_to_stop_ends_the_work() -> None:
    """What runs is ended, what is pending is not begun, and no process is left."""
    others = set(descendants(os.getpid()))
    with LocalWorkers(1, LIMIT) as pool:
        before = all_of(pool, Task("pid", os.getpid, ()))
        reasons = iter([None, None, "interrupted"])
        assert list(pool.run([Task(k, wait, ()) for k in range(50)], lambda: next(reasons))) == []
        assert all_of(pool, Task("pid", os.getpid, ())) != before
        processes = set(descendants(os.getpid())) - others
        assert len(processes) >= 2
    assert not processes & set(descendants(os.getpid()))


def test_preloaded_modules_are_loaded_in_every_worker() -> None:
    """Modules the spawner has loaded are loaded in workers, also in those that replace others."""
    with LocalWorkers(1, LIMIT, (load, ("colorsys",))) as pool:
        found = all_of(pool, Task(1, loaded, ("colorsys",)), Task(2, os._exit, (1,)), Task(3, loaded, ("colorsys",)))
        assert (found[1], found[3]) == (True, True)
        assert all_of(pool, Task(4, loaded, ("mailbox",))) == {4: False}


def test_without_a_spawner_the_work_ends_with_an_error() -> None:
    """If the process that starts workers is killed, its workers go too, and that is one clear error."""
    with LocalWorkers(1, LIMIT) as pool:
        (worker,) = all_of(pool, Task("pid", os.getpid, ())).values()
        spawner = int(Path(f"/proc/{worker}/stat").read_text().rpartition(")")[2].split()[1])
        os.kill(spawner, signal.SIGKILL)
        with pytest.raises(SilenceError, match="the process that starts workers is gone"):
            all_of(pool, Task("wait", wait, ()))
        assert worker not in descendants(os.getpid())


def test_cpu_time_is_that_of_the_process() -> None:
    """The clock stands still for a process that does not exist, and runs while this one computes."""
    begun, end = cpu_time(os.getpid()), monotonic() + 30.0
    while cpu_time(os.getpid()) <= begun:
        assert monotonic() < end, "waited 30 s for CPU time to be counted"
    assert cpu_time(2**22 + 1) == 0.0


SCRIPT = f"""
import os, sys
from space_robot_studies.engine.local_workers import LocalWorkers
from space_robot_studies.engine.tasks import Task
from {HERE} import loaded
sys.modules["mark_of_the_parent"] = sys
with LocalWorkers(1, 60.0) as pool:
    print([outcome for _, outcome in pool.run([Task(1, loaded, ("mark_of_the_parent",))], lambda: None)])
"""


@pytest.mark.parametrize("threads", [0, 1])
def test_a_script_needs_no_guard_and_is_forked_only_with_one_thread(threads: int) -> None:
    """A script without a main guard has workers; they are copies of its process if that has a single thread."""
    more = "import threading\nthreading.Thread(target=threading.Event().wait, daemon=True).start()\n"
    done = subprocess.run(
        [sys.executable, "-c", more * threads + SCRIPT],
        cwd=ROOT,
        env=os.environ | PINNED,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.stdout == f"[{not threads}]\n", done.stderr


def test_a_killed_parent_leaves_no_process() -> None:
    """Spawner and workers end with the process that uses them, however that ends, also in the middle of a task."""
    program = f"""
from space_robot_studies.engine.local_workers import LocalWorkers
from space_robot_studies.engine.tasks import Task
from {HERE} import loop
with LocalWorkers(2, 60.0) as pool:
    list(pool.run([Task(k, loop, ()) for k in range(2)], lambda: None))
"""
    command = [sys.executable, "-c", program]
    with subprocess.Popen(command, cwd=ROOT, env=os.environ | PINNED) as parent:
        end = monotonic() + 60.0
        while len(below := descendants(parent.pid)) < 3:
            assert monotonic() < end, f"waited 60 s for three processes, saw {below}"
        parent.kill()
        parent.wait()
    while any(Path(f"/proc/{pid}").exists() for pid in below):
        assert monotonic() < end, f"waited for {below} to end"
