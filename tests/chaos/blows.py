"""Every process of a paced run with two controllers and a supervisor is killed or stopped, at random instants.

python -m tests.chaos.blows --repeats 20 [--victims controller parent]

A row is as it should be when the response is the one that docs/modes.md states and within its periods, the log can be
read and lacks one period at most, nothing of the run lives on, and what the log has is replayed equal. Exit 1 where
one is not.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import random
import signal
import sys
import tempfile
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import dropwhile
from pathlib import Path
from statistics import median
from time import monotonic, sleep

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.heartbeats import SILENT_SECONDS
from space_robot_bringup.modes.hooks import Hooks, roles_of
from space_robot_bringup.modes.processes import run_processes
from space_robot_bringup.modes.tether import PARENT_DIED
from space_robot_bringup.replay.replay import ReplayOptions, replay
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.topics import BASE_ODOM, WRENCH_COMMAND
from space_robot_sim.nodes.tick_parts import MAX_LATE
from space_robot_sim.nodes.turns import PATIENCE
from tests.chaos.victims import DEADLINE, PARENT, await_gone, observer
from tests.support.forks import Fork
from tests.support.processes import nodes_below

EXPERIMENT, PERIOD = "liu2023/fig08", 0.25
VICTIMS = (*roles_of(supervised=True, failover=True), PARENT)
PAIR = ("controller", "standby")
# 20 periods of a second each, as long as a process takes to notice anything on a busy machine.
REALTIME, FAILOVER, STEPS, BEGUN = 5.0, 3, 160, 20
# Of a run that a silence ends: long enough that it is not over before that is noticed.
LONG_STEPS = STEPS + round(2.0 * SILENT_SECONDS * REALTIME / PERIOD)
OVERRIDES = ("supervision=mini_basic", "controller.gains.update=rls")
# A run that is over is gone in so many seconds.
END_SECONDS = 2.0


@dataclass(frozen=True, slots=True)
class Blow:
    """What is done: ``kill``, or ``stop`` for so many seconds (none: for ever), so long after the run has begun [s]."""

    victim: str
    action: str
    delay: float
    seconds: float | None

    @property
    def expected(self) -> tuple[str, ...]:
        """The reasons of which the log has one."""
        if self.victim in PAIR or (self.seconds is not None and self.seconds < SILENT_SECONDS):
            return ("completed",)
        if self.victim == PARENT:
            return (PARENT_DIED,)
        if self.action == "kill":
            return (f"{self.victim}: its process ended with signal SIGKILL",)
        silent = f"{self.victim}: its process was silent"
        return (f"{silent} for {SILENT_SECONDS:g} s", *((silent,) if self.victim == "recorder" else ()))

    @property
    def steps(self) -> int:
        """Periods of the run."""
        return STEPS if self.expected == ("completed",) else LONG_STEPS

    def limit(self, end: float) -> float:
        """So long until nothing lives on [s]; of a run that goes on until it completes there is none."""
        if self.expected == ("completed",):
            return float("inf")
        return end + (0.0 if self.action == "kill" else SILENT_SECONDS)


@dataclass(frozen=True, slots=True)
class Remains:
    """What is left: time to the end [s], orphans, reason, states not in the log, longest silence [periods], replay."""

    seconds: float
    orphans: int
    reason: str | None
    lost: int
    silent: int
    equal: bool


def draw(victim: str, rng: random.Random) -> Blow:
    """A blow at a random instant; half are kills."""
    action = rng.choice(("kill", "stop"))
    survives = victim in PAIR or victim == PARENT
    seconds = rng.uniform(0.05, 3.0 if victim == PARENT else 7.0) if survives else None
    return Blow(victim, action, rng.uniform(0.0, 2.0), seconds if action == "stop" else None)


def run(place: Path, board: Path, steps: int) -> None:
    """The run that is struck; a board comes to be when it has begun."""

    def on_tick(tick: int) -> None:
        if tick >= BEGUN:
            board.touch()

    composition = compose(load_experiment(EXPERIMENT, (f"duration={steps * PERIOD}", *OVERRIDES)))
    run_processes(composition, place, hooks=Hooks(on_tick), realtime=REALTIME, failover=FAILOVER)


def strike(blow: Blow, place: Path) -> Remains:
    """Run, strike, and look at what is left."""
    with observer() as newest:
        parent = _started(place, blow.steps)
        children = nodes_below(parent.pid)
        assert set(children) == set(VICTIMS) - {PARENT}, children
        sleep(blow.delay)
        pid = parent.pid if blow.victim == PARENT else children[blow.victim]
        begun = monotonic()
        with contextlib.suppress(ProcessLookupError):
            os.kill(pid, signal.SIGKILL if blow.action == "kill" else signal.SIGSTOP)
        if blow.seconds is not None:
            sleep(blow.seconds)
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal.SIGCONT)
        parent.wait()
        orphans = await_gone(children.values())
        ended, reached = monotonic(), newest()
    for one in orphans:
        with contextlib.suppress(ProcessLookupError):
            os.kill(one, signal.SIGKILL)
    return _remains(place, ended - begun, len(orphans), reached)


def _remains(place: Path, seconds: float, orphans: int, reached: int) -> Remains:
    reader, period = LogReader(place), round(PERIOD * 1e9)
    rows = [parts for _, parts in reader.stamps() if BASE_ODOM.name in parts]
    answered = [WRENCH_COMMAND.name in parts for parts in rows]
    outcomes = replay(place, ReplayOptions()).outcomes
    equal = all(one.first is None for one in outcomes) and len(outcomes) == 3
    lost = reached // period + 1 - len(rows)
    return Remains(seconds, orphans, reader.end_reason, max(0, lost), _longest_silence(answered), equal)


def _longest_silence(answered: Iterable[bool]) -> int:
    """Of states in a row without an answer, between two that have one."""
    longest, silent = 0, 0
    # Before the first answer the controllers are not there yet.
    for one in dropwhile(lambda one: not one, answered):
        longest, silent = (max(longest, silent), 0) if one else (longest, silent + 1)
    return longest


def faults(blow: Blow, found: Remains, end: float = END_SECONDS) -> list[str]:
    """What is not as it should be; a run that is over is to be gone within so many seconds."""
    # Until the end is ordered the clock goes on; ticks without a command wait in a recorder for one that may still act.
    clock = int((found.seconds + 0.5) * REALTIME / PERIOD)
    allowed = 1 if found.reason == "completed" else 1 + clock
    allowed += MAX_LATE if blow.victim == "recorder" else 0
    checks = {
        f"took {found.seconds:.2f} s": found.seconds <= blow.limit(end),
        f"{found.orphans} orphans": not found.orphans,
        f"the log says {found.reason!r}": found.reason in blow.expected,
        f"lost {found.lost} ticks": found.lost <= allowed,
        f"silent for {found.silent} periods": found.silent <= FAILOVER * (1 + PATIENCE),
        "not replayed equal": found.equal,
    }
    return [f"{blow}: {text}" for text, fine in checks.items() if not fine]


def _started(place: Path, steps: int) -> Fork:
    """A run in a process of its own that has begun."""
    board = place.parent / "board"
    parent, deadline = Fork(run, place, board, steps), monotonic() + DEADLINE
    while not board.exists():
        assert parent.poll() is None, parent.communicate()
        assert monotonic() < deadline, f"waited {DEADLINE} s for tick {BEGUN}"
        sleep(0.005)
    return parent


def main(arguments: list[str] | None = None) -> int:
    """Strike every process and print what came of it."""
    parser = argparse.ArgumentParser(prog="python -m tests.chaos.blows", description=__doc__.partition("\n")[0])
    parser.add_argument("--repeats", type=int, default=20, help="blows to each process")
    parser.add_argument("--victims", nargs="+", choices=VICTIMS, default=VICTIMS)
    parser.add_argument("--limit", type=float, default=END_SECONDS, help="a run may take so long to end [s]")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args(arguments)
    print(f"seed {options.seed}, {os.cpu_count()} processors, load {os.getloadavg()[0]:.1f}")
    print(f"{'victim':<12}{'kills':>6}{'stops':>6}{'end [s] median, max':>22}{'silent max':>11}{'lost max':>9}  wrong")
    bad = 0
    for victim in options.victims:
        rng = random.Random(f"{options.seed} {victim}")
        blows = [draw(victim, rng) for _ in range(options.repeats)]
        remains, wrong = [], list[str]()
        for blow in blows:
            with tempfile.TemporaryDirectory() as scratch:
                remains.append(strike(blow, Path(scratch) / "run"))
            wrong += faults(blow, remains[-1], options.limit)
            print(f"{blow} {remains[-1]}", file=sys.stderr, flush=True)
        bad += len(wrong)
        print(_row(victim, blows, remains, wrong), flush=True)
    return 1 if bad else 0


def _row(victim: str, blows: list[Blow], remains: list[Remains], wrong: list[str]) -> str:
    actions, ends = Counter(blow.action for blow in blows), [found.seconds for found in remains]
    silent, lost = max(found.silent for found in remains), max(found.lost for found in remains)
    kinds = f"{victim:<12}{actions['kill']:>6}{actions['stop']:>6}"
    return f"{kinds}{f'{median(ends):.2f}, {max(ends):.2f}':>22}{silent:>11}{lost:>9}  {'; '.join(wrong) or 'nothing'}"


if __name__ == "__main__":
    sys.exit(main())
