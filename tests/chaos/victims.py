"""One run in processes, one of which is killed at a random instant: what was left behind."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from time import monotonic, sleep

import pytest

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes import processes
from space_robot_bringup.modes.context import local_context, reserved_domain
from space_robot_bringup.modes.graph import make_executor
from space_robot_bringup.modes.hooks import ROLES, Hooks
from space_robot_bringup.modes.tether import PARENT_DIED
from space_robot_msgs_py.codec.codecs import peek_stamp
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.nodes.base import GraphNode
from space_robot_msgs_py.topics import BASE_ODOM
from tests.support.processes import nodes_below

PARENT = "parent"
VICTIMS = ("controller", "simulator", "guidance", "recorder", PARENT)
OVERRIDES = ("duration=25000.0",)
BEGUN_TICKS = 20
DEADLINE = 60.0

# Runs in place of the tool, whose own judgement of a long log is not what is measured here.
PILOT = """
import sys
from pathlib import Path
from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.hooks import Hooks
from space_robot_bringup.modes.processes import run_processes
place, realtime, late, *overrides = sys.argv[1:]
late = {role: 1e6 for role in late.split(",") if role}
composition = compose(load_experiment("liu2023/fig08", overrides))
hooks = Hooks(on_tick=lambda tick: print(tick, flush=True))
run_processes(composition, Path(place), realtime=float(realtime) or None, hooks=hooks, late=late)
"""


@dataclass(frozen=True, slots=True)
class Remains:
    """What a killed process left behind.

    Attributes:
        victim: role, or ``parent``.
        seconds: from the kill until the last process of the run was gone.
        decided: from the kill until the parent ordered the others to end, by its own clock; None: it was the victim.
        orphans: processes of the run that were still there after ``DEADLINE``.
        reason: of the end, in the log.
        said: of the end, by the parent.
        lost: states that were out and are not in the log.
        litter: temporary files and folders.
    """

    victim: str
    seconds: float
    decided: float | None
    orphans: int
    reason: str | None
    said: str | None
    lost: int
    litter: tuple[str, ...]

    @property
    def expected(self) -> str:
        """The reason that the log has to have."""
        return PARENT_DIED if self.victim == PARENT else f"{self.victim}: its process ended with signal SIGKILL"


@dataclass(frozen=True, slots=True)
class Kill:
    """What is killed, and when.

    Attributes:
        victim: role, or ``parent``.
        place: run directory.
        delay: [s] after the run has begun.
        realtime: simulated seconds per second; None: lock-step.
        overrides: of the experiment.
        alone: only the recorder was started yet; for ``parent``.
        starved: what is left of the run gets a tenth of the time from then on; for ``parent``.
    """

    victim: str
    place: Path
    delay: float = 0.0
    realtime: float | None = None
    overrides: tuple[str, ...] = OVERRIDES
    alone: bool = False
    starved: bool = False


def kill_one(kill: Kill) -> Remains:
    """Run, kill, and look at what is left."""
    place = kill.place
    temporary = place.with_name("temporary")
    temporary.mkdir()
    with temporary_folder(temporary), observer() as newest:
        seconds, decided, orphans, said = (_kill_parent if kill.victim == PARENT else _kill_child)(kill)
        reached = newest()
    reader = LogReader(place)
    period = load_experiment("liu2023/fig08").period
    logged = max((stamp for stamp, parts in reader.stamps() if BASE_ODOM.name in parts), default=-period)
    litter = (*(path.name for path in temporary.iterdir()), *(path.name for path in place.rglob("*.tmp")))
    lost = max(0, (reached - logged) // period)
    return Remains(kill.victim, seconds, decided, orphans, reader.end_reason, said, lost, litter)


def _kill_child(kill: Kill) -> tuple[float, float | None, int, str | None]:
    composition = compose(load_experiment("liu2023/fig08", kill.overrides))
    killed: list[float] = []
    decided: list[float] = []
    children: dict[str, int] = {}

    class TimedProcesses(processes._NodeProcesses):
        def _end_all(self, reason: str, *, hurry: bool = False) -> None:
            decided.append(monotonic())
            super()._end_all(reason, hurry=hurry)

    def on_tick(tick: int) -> None:
        if tick >= BEGUN_TICKS and not killed:
            sleep(kill.delay)
            children.update(nodes_below(os.getpid()))
            killed.append(monotonic())
            os.kill(children[kill.victim], signal.SIGKILL)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(processes, "_NodeProcesses", TimedProcesses)
        said = processes.run_processes(composition, kill.place, realtime=kill.realtime, hooks=Hooks(on_tick))
    ended = monotonic()
    return ended - killed[0], decided[0] - killed[0], len(await_gone(children.values())), said


def _kill_parent(kill: Kill) -> tuple[float, float | None, int, str | None]:
    late = [role for role in ROLES if kill.alone and role != "recorder"]
    command = [sys.executable, "-c", PILOT, str(kill.place), str(kill.realtime or 0.0), ",".join(late)]
    bag = kill.place / f"{kill.place.name}_0.mcap"
    with subprocess.Popen([*command, *kill.overrides], stdout=subprocess.PIPE, text=True) as parent:
        assert parent.stdout is not None
        for line in parent.stdout:
            if int(line) >= BEGUN_TICKS or (kill.alone and bag.exists() and bag.stat().st_size):
                break
        sleep(kill.delay)
        children = nodes_below(parent.pid)
        assert set(children) == set(ROLES) - set(late)
        parent.kill()
        killed = monotonic()
        parent.wait()
        if kill.starved:
            starve(children.values())
        orphans = await_gone(children.values())
        ended = monotonic()
    for pid in orphans:
        with contextlib.suppress(ProcessLookupError):
            os.kill(pid, signal.SIGKILL)
    return ended - killed, None, len(orphans), None


def starve(pids: Iterable[int]) -> None:
    """Let processes run for a tenth of the time, as beside a dozen others, until they are gone."""
    deadline = monotonic() + DEADLINE
    while (left := [pid for pid in pids if _lives(pid)]) and monotonic() < deadline:
        for order, seconds in ((signal.SIGSTOP, 0.018), (signal.SIGCONT, 0.002)):
            for pid in left:
                with contextlib.suppress(ProcessLookupError):
                    os.kill(pid, order)
            sleep(seconds)


def await_gone(pids: Iterable[int]) -> list[int]:
    """Wait until the processes are gone; those that are not."""
    left, deadline = list(pids), monotonic() + DEADLINE
    while (left := [pid for pid in left if _lives(pid)]) and monotonic() < deadline:
        sleep(0.01)
    return left


def _lives(pid: int) -> bool:
    try:
        # A zombie is dead, and only not yet buried by whatever has inherited it.
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


@contextlib.contextmanager
def temporary_folder(folder: Path) -> Iterator[None]:
    """Where this process and those it starts put temporary files."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("TMPDIR", str(folder))
        patch.setattr(tempfile, "tempdir", str(folder))
        yield


@contextlib.contextmanager
def observer() -> Iterator[Callable[[], int]]:
    """On a domain for the run, which listens to the states; gives the newest stamp that was out [ns]."""
    with reserved_domain() as domain, local_context(domain) as context, pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_DOMAIN_ID", str(domain))
        newest, over = [-1], threading.Event()
        node = GraphNode("observer", context=context, start_parameter_services=False, enable_rosout=False)
        node.listen(BASE_ODOM, lambda raw: newest.append(max(newest.pop(), peek_stamp(raw))))
        executor = make_executor(context)
        executor.add_node(node)

        def spin() -> None:
            while not over.is_set():
                executor.spin_once(timeout_sec=0.05)

        thread = threading.Thread(target=spin)
        thread.start()
        try:
            yield lambda: newest[0]
        finally:
            over.set()
            thread.join()
            executor.shutdown()
            node.destroy_node()
