"""A domain belongs to one run at a time, from its first process to its last."""

from __future__ import annotations

import socket
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("rclpy")

from domain_coordinator import domain_id

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes import context, processes
from space_robot_bringup.modes.context import MAX_RESERVED, reservations, reserved_domain
from space_robot_bringup.modes.hooks import Hooks
from space_robot_msgs_py.errors import SpecError

pytestmark = pytest.mark.ros
WAITING = "import sys; sys.stdin.read()"


def is_free(number: int) -> bool:
    """Whether another run could take this domain."""
    with socket.socket() as other:
        try:
            other.bind(("", context.PORT_BASE + number))
        except OSError:
            return False
    return True


def test_a_domain_is_taken_until_the_last_process_on_it_is_gone() -> None:
    """Also where the one that took it is gone before: its children are given what holds it."""
    with reserved_domain() as number:
        assert not is_free(number)
        child = subprocess.Popen([sys.executable, "-c", WAITING], stdin=subprocess.PIPE, pass_fds=reservations())
    assert reservations() == ()
    assert not is_free(number)
    child.communicate()
    assert is_free(number)


def test_the_processes_of_a_run_hold_its_domain(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each of them, so that a run whose starter was killed keeps its domain until its last node is gone."""
    given: list[tuple[int, ...]] = []

    def start(arguments: Any, environment: Any, descriptors: Any) -> Any:
        given.append(descriptors)
        return subprocess.Popen(["true"], env=environment, pass_fds=descriptors)

    monkeypatch.setattr(processes, "start_node", start)
    composition = compose(load_experiment("liu2023/fig08"))
    with reserved_domain() as number:
        monkeypatch.setenv("ROS_DOMAIN_ID", str(number))
        held = set(reservations())
        processes.run_processes(composition, tmp_path / "run", realtime=None, hooks=Hooks(stop=lambda: "enough"))
    assert len(held) == 1
    assert [held <= set(one) for one in given] == [True] * 4


def test_a_domain_that_was_left_is_not_the_next_one() -> None:
    """What still leaves it disturbs nothing; those of other programs that use domain_coordinator are left alone."""
    with reserved_domain() as first:
        pass
    with domain_id() as other, reserved_domain() as second, reserved_domain() as third:
        assert len({first, int(other), second, third}) == 4
        assert 1 <= second <= MAX_RESERVED


def test_where_every_domain_is_taken_a_run_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """In one line."""
    with reserved_domain() as number:
        monkeypatch.setattr(context, "MAX_RESERVED", 1)
        monkeypatch.setattr(context, "PORT_BASE", context.PORT_BASE + number - 1)
        with pytest.raises(SpecError, match="every domain is in use"), reserved_domain():
            pytest.fail("it was given one")
