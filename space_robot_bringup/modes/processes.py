"""The processes mode: the same nodes, one process each, on a domain of their own."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path
from time import monotonic, sleep
from typing import TYPE_CHECKING

from space_robot_bringup.compose.composition import Composition
from space_robot_bringup.modes.context import reserved_domain
from space_robot_bringup.modes.hooks import ROLES
from space_robot_bringup.modes.signals import REASONS
from space_robot_msgs_py.log.reader import LogReader

if TYPE_CHECKING:
    from space_robot_bringup.modes.hooks import Hooks

POLL_SECONDS = 0.02
GRACE_SECONDS = 10.0
# A node that fails says why before it ends; on a busy machine the recorder takes a while to hear it.
HEARING_SECONDS = 3.0


def fly_processes(
    composition: Composition,
    directory: Path,
    *,
    realtime: float | None,
    hooks: Hooks,
    late: Mapping[str, float] | None = None,
) -> str:
    """Fly one run with one process per node and return the reason of its end.

    Args:
        composition: checked experiment; the children get its resolved form, not the file it came from.
        directory: run directory.
        realtime: simulated seconds per second; None: lock-step.
        hooks: progress and early end.
        late: seconds by which a role starts after the others.
    """
    with tempfile.TemporaryDirectory(prefix="space-robot-") as scratch, reserved_domain() as domain:
        crew = _Crew(composition, directory, realtime, Path(scratch), domain, late or {})
        try:
            return crew.watch(hooks)
        finally:
            crew.end()


class _Crew:
    """The child processes of one run."""

    def __init__(
        self,
        composition: Composition,
        directory: Path,
        realtime: float | None,
        scratch: Path,
        domain: int,
        late: Mapping[str, float],
    ) -> None:
        self._directory, self._progress = directory, scratch / "progress"
        experiment = scratch / "experiment.yaml"
        experiment.write_text(composition.header.experiment, encoding="utf-8")
        self._arguments = ["--experiment", str(experiment), "--out", str(directory)]
        if realtime is not None:
            self._arguments += ["--realtime", repr(realtime)]
        self._environment = os.environ | {"ROS_DOMAIN_ID": str(domain)}
        self._children: dict[str, subprocess.Popen[bytes]] = {}
        self._due = {role: monotonic() + late.get(role, 0.0) for role in ROLES}

    def watch(self, hooks: Hooks) -> str:
        """Start who is due, follow the recorder, and end the run when it ends or somebody dies."""
        asked, give_up, seen = None, float("inf"), float("inf")
        while True:
            self._start_due()
            hooks.on_tick(self._tick())
            recorder = self._children.get("recorder")
            if recorder is not None and recorder.poll() is not None:
                return self._reason(recorder, asked)
            casualty = self._casualty()
            seen = seen if casualty is None else min(seen, monotonic())
            reason = hooks.stop() or (casualty if monotonic() - seen > HEARING_SECONDS else None)
            if reason is not None and asked is None:
                asked, give_up = reason, monotonic() + GRACE_SECONDS
                self._signal(signal.SIGINT if reason != "terminated" else signal.SIGTERM)
            if monotonic() > give_up:
                return asked or "failed"
            sleep(POLL_SECONDS)

    def end(self) -> None:
        """No child survives the run."""
        deadline = monotonic() + GRACE_SECONDS
        for child in self._children.values():
            try:
                child.wait(max(0.0, deadline - monotonic()))
            except subprocess.TimeoutExpired:
                child.kill()
                child.wait()

    def _start_due(self) -> None:
        for role in [role for role, due in self._due.items() if monotonic() >= due]:
            del self._due[role]
            command = [sys.executable, "-m", "space_robot_bringup.nodes.process", role, *self._arguments]
            follow = role == "recorder"
            with (self._progress if follow else Path(os.devnull)).open("wb") as out:
                # A session of its own: Ctrl-C in the terminal reaches this process only, which then ends them in order.
                self._children[role] = subprocess.Popen(
                    command + ["--progress"] * follow, stdout=out, env=self._environment, start_new_session=True
                )

    def _tick(self) -> int:
        try:
            lines = self._progress.read_text().split("\n")
        except FileNotFoundError:
            return -1
        return int(lines[-2].removeprefix("tick ")) if len(lines) > 1 else -1

    def _casualty(self) -> str | None:
        for role, child in self._children.items():
            code = child.poll()
            if role != "recorder" and code:
                what = f"signal {signal.Signals(-code).name}" if code < 0 else f"exit code {code}"
                return f"{role}: its process ended with {what}"
        return None

    def _signal(self, number: signal.Signals) -> None:
        for child in self._children.values():
            if child.poll() is None:
                child.send_signal(number)

    def _reason(self, recorder: subprocess.Popen[bytes], asked: str | None) -> str:
        """What the log says; where it only says that it was told to stop, what made us tell it."""
        if recorder.returncode != 0:
            return asked or f"recorder: its process ended with exit code {recorder.returncode}"
        logged = LogReader(self._directory).end_reason or "cut"
        return asked if asked is not None and logged in REASONS.values() else logged
