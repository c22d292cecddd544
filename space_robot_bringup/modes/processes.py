"""The processes mode: the same nodes, one process each, on a domain of their own."""

from __future__ import annotations

import os
import selectors
import signal
import subprocess
import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Any

from space_robot_bringup.compose.composition import Composition
from space_robot_bringup.ends import of_process
from space_robot_bringup.modes.chaos import Blow, plan
from space_robot_bringup.modes.context import reservations, reserved_domain
from space_robot_bringup.modes.forked import ForkedProcess
from space_robot_bringup.modes.heartbeats import Heartbeats, silence_of
from space_robot_bringup.modes.hooks import roles_of
from space_robot_bringup.modes.starting import prepare_nodes, start_node
from space_robot_bringup.modes.tether import CLOSING_SECONDS, ParentEnd
from space_robot_msgs_py.codec.accepted import CONTROLLERS
from space_robot_msgs_py.errors import LogError
from space_robot_msgs_py.log.closing import close_log_of_dead_writer
from space_robot_msgs_py.log.run_directory import RunDirectory

if TYPE_CHECKING:
    from space_robot_bringup.modes.hooks import Hooks

POLL_SECONDS = 0.05
# What a process that was ordered to end may take; the recorder may take longer, once it has a log to close.
END_SECONDS = 1.0
RECORDER = "recorder"


def run_processes(
    composition: Composition,
    directory: Path | RunDirectory,
    *,
    realtime: float | None,
    hooks: Hooks,
    late: Mapping[str, float] | None = None,
    failover: int = 0,
    chaos: int | None = None,
) -> str:
    """Execute a run with one process per node and return the reason of its end.

    Args:
        composition: checked experiment; the children get its resolved form, not the file it came from.
        directory: run directory.
        realtime: simulated seconds per second; None: lock-step.
        hooks: progress and early end.
        late: seconds by which a role starts after the others.
        failover: paced: periods of silence after which a second controller takes over; 0: there is none.
        chaos: paced: seed of what is done to the processes; None: nothing.

    Raises:
        LogError: another run writes to the directory, or it cannot be made.
    """
    if not isinstance(directory, RunDirectory):
        with RunDirectory(directory) as place:
            extra: dict[str, Any] = {"late": late, "failover": failover, "chaos": chaos}
            return run_processes(composition, place, realtime=realtime, hooks=hooks, **extra)
    # A file without a name: however this process ends, nothing of it stays.
    with tempfile.TemporaryFile(prefix="space-robot-") as experiment, reserved_domain() as domain:
        experiment.write(composition.header.experiment.encode())
        experiment.flush()
        roles = roles_of(supervised=composition.experiment.supervision is not None, failover=failover > 0)
        starts = {role: (late or {}).get(role, 0.0) for role in roles}
        blows = () if chaos is None else plan(chaos, composition.experiment.steps, roles)
        arguments = _arguments(realtime, hooks, failover)
        prepare_nodes(experiment.fileno())
        children = _NodeProcesses(directory, arguments, experiment.fileno(), domain, starts, blows)
        try:
            return children.watch(hooks)
        finally:
            children.end()


def _arguments(realtime: float | None, hooks: Hooks, failover: int) -> list[str]:
    paced = [] if realtime is None else ["--realtime", repr(realtime)]
    pair = ["--failover", str(failover)] if failover else []
    return [*paced, *pair, *(["--debug"] if hooks.debug else [])]


class _NodeProcesses:
    """The child processes of one run.

    Args:
        place: run directory.
        arguments: of every child.
        experiment: descriptor of a file with the resolved experiment.
        domain: of the run.
        starts: roles, and by how many seconds each starts late.
        blows: what is done to them.
    """

    def __init__(
        self,
        place: RunDirectory,
        arguments: list[str],
        experiment: int,
        domain: int,
        starts: Mapping[str, float],
        blows: Sequence[Blow] = (),
    ) -> None:
        self._place, self._arguments, self._experiment = place, arguments, experiment
        self._environment = os.environ | {"ROS_DOMAIN_ID": str(domain)}
        self._children: dict[str, ForkedProcess] = {}
        self._tethers: dict[str, ParentEnd] = {}
        self._selector = selectors.DefaultSelector()
        self._due = {role: monotonic() + late for role, late in starts.items()}
        self._tick = -1
        self._recording = False
        self._order: str | None = None
        self._give_up = float("inf")
        self._logged: str | None = None
        self._beats, self._causes = Heartbeats(), dict[str, str]()
        self._blows, self._stopped = list(blows), dict[str, float]()
        self._again: set[str] = set()
        self._warn: Callable[[str], None] = lambda warning: None

    def watch(self, hooks: Hooks) -> str:
        """Start the children, follow them, and end the run when one of them ends or ``hooks.stop`` says so."""
        self._warn = hooks.warn
        while True:
            self._start_due()
            hooks.on_tick(self._tick)
            for key, _ in self._selector.select(POLL_SECONDS):
                self._hear(key.data)
            self._strike()
            self._look_for_silence()
            if self._order is None and (reason := hooks.stop()) is not None:
                self._end_all(reason)
            if self._logged is not None:
                return self._logged
            if self._order is not None and (RECORDER not in self._tethers or monotonic() > self._give_up):
                return self._close_log(self._order)

    def end(self) -> None:
        """No child survives the run."""
        for tether in self._tethers.values():
            tether.order_end(self._order or "failed", hurry=True)
        deadline = monotonic() + END_SECONDS
        for child in self._children.values():
            try:
                child.wait(max(0.0, deadline - monotonic()))
            except subprocess.TimeoutExpired:
                child.kill()
                child.wait()
        for tether in self._tethers.values():
            tether.close()
        self._selector.close()

    def _start_due(self) -> None:
        for role in [role for role, due in self._due.items() if monotonic() >= due and self._order is None]:
            del self._due[role]
            tether = ParentEnd()
            inherited = {"--tether": tether.child.fileno(), "--experiment": self._experiment}
            if role == RECORDER:
                inherited["--directory"] = self._place.descriptor
            arguments = [role, *self._arguments, "--experiment", f"/dev/fd/{self._experiment}"]
            arguments += ["--out", str(self._place.path)]
            arguments += [text for name in inherited if name != "--experiment" for text in (name, str(inherited[name]))]
            descriptors = (*inherited.values(), *reservations())
            self._children[role] = start_node(arguments, self._environment, descriptors)
            tether.child.close()
            self._tethers[role] = tether
            self._selector.register(tether, selectors.EVENT_READ, role)

    def _hear(self, role: str) -> None:
        news = self._tethers[role].news()
        if news is not None:
            if "beat" in news:
                self._beats.hear(role)
            self._take_in(news)
            return
        tether = self._tethers.pop(role)
        self._selector.unregister(tether)
        tether.close()
        self._beats.forget(role)
        if self._order is not None:
            return
        cause = self._cause_of_death(role)
        if not self._has_another(role):
            self._end_all(cause, hurry=True)
            return
        self._warn(cause)
        if role in self._again:
            self._again.discard(role)
            self._due[role] = monotonic()

    def _has_another(self, role: str) -> bool:
        """Whether it is one of two controllers, and the other one is there."""
        return role in CONTROLLERS and any(one in self._tethers for one in CONTROLLERS if one != role)

    def _look_for_silence(self) -> None:
        """A process that is silent is ended: it may be stopped, and would not hear that it should.

        A controller alone is not: the plant holds meanwhile, and a law may take its time.
        """
        if not self._recording or self._order is not None:
            return
        for role in self._beats.silent():
            if role in CONTROLLERS and not self._has_another(role):
                continue
            self._causes[role] = silence_of(role)
            self._beats.forget(role)
            self._children[role].kill()

    def _strike(self) -> None:
        """Do what is planned to the processes."""
        for role in [role for role, until in self._stopped.items() if monotonic() >= until]:
            del self._stopped[role]
            self._children[role].send_signal(signal.SIGCONT)
        while self._blows and self._tick >= self._blows[0].tick and self._order is None:
            blow = self._blows.pop(0)
            self._warn(blow.line)
            if blow.role not in self._tethers:
                continue
            if blow.action == "stop":
                self._stopped[blow.role] = monotonic() + blow.seconds
                self._children[blow.role].send_signal(signal.SIGSTOP)
                continue
            if blow.action == "restart":
                self._again.add(blow.role)
            self._children[blow.role].kill()

    def _take_in(self, news: Mapping[str, Any]) -> None:
        if "tick" in news:
            self._tick, self._recording = news["tick"], True
        if "logged" in news:
            self._logged = str(news["logged"])
        if "end" in news:
            # What ended one node ends all, whether or not they heard of it on the graph.
            self._end_all(str(news["end"]))

    def _end_all(self, reason: str, *, hurry: bool = False) -> None:
        if self._order is not None:
            return
        self._order = reason
        # A recorder that is stopped, too, closes no log.
        closes = self._recording and not self._beats.is_late(RECORDER)
        self._give_up = monotonic() + (CLOSING_SECONDS if closes else END_SECONDS)
        for tether in self._tethers.values():
            tether.order_end(reason, hurry=hurry)

    def _cause_of_death(self, role: str) -> str:
        """Only for a process that did not say itself why it ends."""
        child = self._children[role]
        if role in self._causes:
            child.wait()
            return self._causes.pop(role)
        try:
            code = child.wait(END_SECONDS)
        except subprocess.TimeoutExpired:
            return of_process(role, "let go of the run")
        what = f"signal {signal.Signals(-code).name}" if code < 0 else f"exit code {code}"
        return of_process(role, f"ended with {what}")

    def _close_log(self, reason: str) -> str:
        """In place of a recorder that is no more, or that never gets there."""
        recorder = self._children.get(RECORDER)
        if RECORDER in self._tethers and self._beats.is_late(RECORDER) and reason == "completed":
            # The plant got to its end, but the log did not.
            reason = of_process(RECORDER, "was silent")
        if recorder is not None:
            recorder.kill()
            recorder.wait()
        try:
            close_log_of_dead_writer(self._place, reason, {"mode": "processes"})
        except LogError as error:
            return f"recorder: {error}"
        return reason
