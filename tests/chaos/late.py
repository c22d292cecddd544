"""Nodes that come late, come and go, begin again: is every command that acted in the log, and nothing lost?

python -m tests.chaos.late --repeats 20 [--only late-1.5 late-5 late-20 pair listener restart] [--realtime 4]

Paced runs in processes of their own, the late ones beside a busy core. A row is as it should be when the log lacks no
state and no command that acted, and a replay is equal; a node that listens misses nothing between the first message
that it hears and the last. Exit 1 where one is not.
"""

from __future__ import annotations

import argparse
import os
import signal
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from time import monotonic, sleep

import pytest

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.context import local_context, reservations, reserved_domain
from space_robot_bringup.modes.graph import make_executor
from space_robot_bringup.modes.hooks import ROLES, Hooks
from space_robot_bringup.modes.processes import run_processes
from space_robot_msgs_py.codec.codecs import peek_stamp
from space_robot_msgs_py.nodes.base import GraphNode
from space_robot_msgs_py.topics import BASE_ODOM, REFERENCE_BASE, WRENCH_COMMAND
from tests.support.busy import burning_core
from tests.support.follow import DEADLINE
from tests.support.late import ENOUGH, OVERRIDES, PERIOD, Enough, Tally, tally

BOTH = ("controller", "plant")


@dataclass
class Row:
    """What came of the runs of one kind.

    Attributes:
        runs: how many logs there are.
        good: how many are as they should be.
        ticks, acted, missing, gaps: sums over them, see Tally.
        lost: messages that a listener should have heard and did not.
        wrong: what is not as it should be.
    """

    runs: int = 0
    good: int = 0
    ticks: int = 0
    acted: int = 0
    missing: int = 0
    gaps: int = 0
    lost: int = 0
    wrong: list[str] = field(default_factory=list)

    def enter(self, found: Tally, sides: tuple[str, ...] = BOTH, lost: int = 0) -> None:
        """Add a run, whose replay has to be equal on these sides."""
        unequal = [side for side in sides if not found.equal[side]]
        self.runs, self.ticks, self.acted = self.runs + 1, self.ticks + found.ticks, self.acted + found.acted
        self.missing, self.gaps, self.lost = self.missing + found.missing, self.gaps + found.gaps, self.lost + lost
        if unequal or found.missing or found.gaps or lost:
            self.wrong.append(f"{found}, {lost} lost")
        else:
            self.good += 1


def late(row: Row, folder: Path, realtime: float, seconds: float) -> None:
    """The controller starts so many seconds after the others, beside a busy core."""
    with burning_core():
        _run(folder / "run", realtime, {"controller": seconds})
    row.enter(tally(folder / "run"))


def pair(row: Row, folder: Path, realtime: float) -> None:
    """Two runs at a time, each on the domain that it finds."""
    places = [folder / name / "run" for name in ("one", "two")]
    with ThreadPoolExecutor(len(places)) as threads:
        list(threads.map(lambda place: _run(place, realtime), places))
    for place in places:
        row.enter(tally(place))


def listener(row: Row, folder: Path, realtime: float) -> None:
    """A node that listens comes in mid-run, another one leaves, a third one is killed."""
    with reserved_domain() as domain, pytest.MonkeyPatch.context() as patch, ExitStack() as stack:
        patch.setenv("ROS_DOMAIN_ID", str(domain))
        heard: dict[str, list[int]] = {}
        leaver = subprocess.Popen([sys.executable, "-m", "tests.chaos.late", "--listen"], stdout=subprocess.DEVNULL)
        stack.callback(leaver.wait)
        stack.callback(leaver.kill)
        begun = monotonic()

        def come_and_go(tick: int) -> None:
            if tick > ENOUGH // 4 and not heard:
                heard.update({topic.name: [] for topic in (BASE_ODOM, REFERENCE_BASE, WRENCH_COMMAND)})
                stack.enter_context(_listening(domain, heard))
                with _listening(domain, {}):
                    leaver.kill()

        _run(folder / "run", realtime, on_tick=come_and_go, count=2 * ENOUGH)
        assert monotonic() - begun < DEADLINE
    row.enter(tally(folder / "run"), lost=sum(_holes(set(stamps)) for stamps in heard.values()))


def restart(row: Row, folder: Path, realtime: float) -> None:
    """Nodes started by hand: the controller is killed in mid-run, and another one takes its place."""
    place = folder / "run"
    with reserved_domain() as domain, ExitStack() as stack:

        def start(role: str) -> subprocess.Popen[bytes]:
            sets = [word for one in OVERRIDES for word in ("--set", one)]
            command = [sys.executable, "-m", "space_robot_bringup.nodes.process", role, "--out", str(place), *sets]
            child = subprocess.Popen(
                [*command, "--realtime", str(realtime)],
                env=os.environ | {"ROS_DOMAIN_ID": str(domain)},
                pass_fds=reservations(),
                stderr=subprocess.DEVNULL,
            )
            stack.callback(child.wait)
            stack.callback(child.kill)
            return child

        children = {role: start(role) for role in ROLES}
        _await(Enough(place))
        children["controller"].kill()
        children["controller"].wait()
        before = Enough(place).count
        start("controller")
        _await(Enough(place, before + ENOUGH))
        children["simulator"].send_signal(signal.SIGINT)
        children["recorder"].wait(DEADLINE)
    # The log does not tell that the second controller began with an empty memory.
    row.enter(tally(place), ("plant",))


def _await(enough: Enough) -> None:
    while enough() is None:
        sleep(0.2)


def _run(
    place: Path,
    realtime: float,
    late: dict[str, float] | None = None,
    on_tick: Callable[[int], None] = lambda tick: None,
    count: int = ENOUGH,
) -> None:
    composition, hooks = compose(load_experiment("liu2023/fig08", OVERRIDES)), Hooks(on_tick, Enough(place, count))
    reason = run_processes(composition, place, realtime=realtime, hooks=hooks, late=late)
    assert reason == "enough", reason


class _listening:
    """Hears the stamps of topics, in a thread, while in its block."""

    def __init__(self, domain: int, heard: dict[str, list[int]]) -> None:
        self._domain, self._heard, self._over = domain, heard, threading.Event()
        self._thread = threading.Thread(target=self._spin)

    def __enter__(self) -> None:
        self._thread.start()

    def __exit__(self, *_: object) -> None:
        self._over.set()
        self._thread.join()

    def _spin(self) -> None:
        with local_context(self._domain) as context:
            node = GraphNode("listener", context=context, start_parameter_services=False, enable_rosout=False)
            for topic in (BASE_ODOM, REFERENCE_BASE, WRENCH_COMMAND):
                stamps = self._heard.get(topic.name, [])
                node.listen(topic, lambda raw, stamps=stamps: stamps.append(peek_stamp(raw)))
            executor = make_executor(context)
            executor.add_node(node)
            while not self._over.is_set():
                executor.spin_once(timeout_sec=0.05)
            executor.shutdown()
            node.destroy_node()


def _holes(stamps: set[int]) -> int:
    """How many ticks are missing between the first and the last."""
    return (max(stamps) - min(stamps)) // PERIOD + 1 - len(stamps) if stamps else 1


KINDS: dict[str, Callable[[Row, Path, float], None]] = {
    **{f"late-{seconds:g}": partial(late, seconds=seconds) for seconds in (1.5, 5.0, 20.0)},
    "pair": pair,
    "listener": listener,
    "restart": restart,
}


def main(arguments: list[str] | None = None) -> int:
    """Run all kinds and print the table."""
    parser = argparse.ArgumentParser(prog="python -m tests.chaos.late", description=__doc__.partition("\n")[0])
    parser.add_argument("--repeats", type=int, default=20, help="runs of each kind")
    parser.add_argument("--only", nargs="+", choices=tuple(KINDS), default=tuple(KINDS))
    parser.add_argument("--realtime", type=float, default=4.0, help="simulated seconds per second")
    parser.add_argument("--listen", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args(arguments)
    if options.listen:
        with _listening(int(os.environ["ROS_DOMAIN_ID"]), {}):
            signal.pause()
    bad = 0
    print(f"{os.cpu_count()} processors, load {os.getloadavg()[0]:.1f}, {options.realtime:g} x real time")
    print(f"{'kind':<10}{'good':>10}{'ticks':>8}{'acted':>8}{'missing':>9}{'gaps':>6}{'unheard':>9}{'load':>7}  wrong")
    for kind in options.only:
        row = Row()
        for _ in range(options.repeats):
            with tempfile.TemporaryDirectory() as scratch:
                try:
                    KINDS[kind](row, Path(scratch), options.realtime)
                except Exception as error:
                    row.runs += 1
                    row.wrong.append(f"{type(error).__name__}: {error}")
        bad += row.runs - row.good
        print(_line(kind, row), flush=True)
    return 1 if bad else 0


def _line(kind: str, row: Row) -> str:
    counts = f"{row.ticks:>8}{row.acted:>8}{row.missing:>9}{row.gaps:>6}{row.lost:>9}{os.getloadavg()[0]:>7.1f}"
    return f"{kind:<10}{f'{row.good} of {row.runs}':>10}{counts}  {'; '.join(row.wrong) or 'nothing'}"


if __name__ == "__main__":
    sys.exit(main())
