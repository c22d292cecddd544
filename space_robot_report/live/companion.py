"""Starts the process that shows a run beside it, on the domain of the run, and ends it with the run."""

from __future__ import annotations

import json
import os
import select
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from importlib.util import find_spec

from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.extras import install
from space_robot_report.live.brief import Brief

START_SECONDS = 120.0
END_SECONDS = 5.0
DOMAIN = "ROS_DOMAIN_ID"


@contextmanager
def shown_live(brief: Brief) -> Iterator[dict[str, str]]:
    """While in the block, runs of this process are shown; gives the addresses, ``view`` and ``foxglove``.

    The process beside has a lower priority and only listens, so a run loses nothing by it; where it ends early, the run
    goes on.

    Raises:
        SpecError: something is not installed, or a port is taken.
    """
    check_installed(brief)
    # Only here: everything else works on a machine without ROS.
    from space_robot_bringup.modes.context import reservations, reserved_domain

    before = os.environ.get(DOMAIN)
    with reserved_domain() as domain:
        os.environ[DOMAIN] = str(domain)
        try:
            child = _started(brief, reservations())
            try:
                yield _addresses(child)
            finally:
                _end(child)
        finally:
            os.environ.pop(DOMAIN)
            if before is not None:
                os.environ[DOMAIN] = before


def check_installed(brief: Brief) -> None:
    """Refuse what cannot be shown here.

    Raises:
        SpecError: it is not installed.
    """
    needs = (("--view", brief.view, "viser", "view"), ("--foxglove", brief.foxglove, "foxglove", "foxglove"))
    for option, port, module, extra in needs:
        if port is not None and find_spec(module) is None:
            raise SpecError(f"needs {module}", key=option, value=port, accepted=install(extra))


def _started(brief: Brief, held: Sequence[int]) -> subprocess.Popen[str]:
    # A session of its own: Ctrl-C in the terminal is for the run.
    child = subprocess.Popen(
        [sys.executable, "-m", "space_robot_report.nodes.live"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        start_new_session=True,
        pass_fds=held,
    )
    assert child.stdin is not None
    with suppress(BrokenPipeError):
        child.stdin.write(f"{brief.line()}\n")
        child.stdin.flush()
    return child


def _addresses(child: subprocess.Popen[str]) -> dict[str, str]:
    assert child.stdout is not None
    ready, _, _ = select.select([child.stdout], [], [], START_SECONDS)
    line = child.stdout.readline() if ready else ""
    found: dict[str, str] = json.loads(line) if line else {"error": "its process ended, or did not start in time"}
    if "error" in found:
        raise SpecError(
            f"the run cannot be shown: {found['error']}", key="run", accepted="a run without --view, --foxglove"
        )
    return found


def _end(child: subprocess.Popen[str]) -> None:
    assert child.stdin is not None
    assert child.stdout is not None
    with suppress(BrokenPipeError):
        child.stdin.close()
    try:
        child.wait(END_SECONDS)
    except subprocess.TimeoutExpired:
        child.kill()
        child.wait()
    child.stdout.close()
