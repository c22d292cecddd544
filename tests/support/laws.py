"""Laws that fail in the ways in which a law can fail."""

from __future__ import annotations

import os
import signal
import time
from threading import Event
from typing import Any

import numpy as np

from space_robot_control.laws.base import Blocks, Law
from space_robot_msgs_py.errors import ControlError
from space_robot_msgs_py.interfaces import NANOSECONDS, Reference, RobotState, Vector


class GivesUp(Law):
    """Ends the run with a reason of its own at 0.5 s."""

    name = "gives_up"

    def compute(self, state: RobotState, reference: Reference) -> tuple[Vector, Blocks]:
        """Return nothing forever."""
        if state.stamp >= NANOSECONDS // 2:
            raise ControlError("enough", key="patience")
        return np.zeros(6 + self.n), {"patience": np.ones(1)}


class Buggy(Law):
    """Raises what no law should."""

    name = "buggy"

    def compute(self, state: RobotState, reference: Reference) -> tuple[Vector, Blocks]:
        """Never return."""
        raise KeyError("a typo")


class Deadly(Law):
    """Takes its whole process with it."""

    name = "deadly"

    def compute(self, state: RobotState, reference: Reference) -> tuple[Vector, Blocks]:
        """Never return."""
        os.kill(os.getpid(), signal.SIGKILL)
        raise AssertionError("survived")


class Exits(Law):
    """Wants to end the process at 0.5 s."""

    name = "exits"

    def compute(self, state: RobotState, reference: Reference) -> tuple[Vector, Blocks]:
        """Return nothing until then."""
        if state.stamp >= NANOSECONDS // 2:
            raise SystemExit("enough of\nthis")
        return np.zeros(6 + self.n), {}


class Leaves(Law):
    """Ends its process without a word."""

    name = "leaves"

    def compute(self, state: RobotState, reference: Reference) -> tuple[Vector, Blocks]:
        """Never return."""
        os._exit(7)


class Endless(Law):
    """Computes for ever from 0.5 s on."""

    name = "endless"

    def compute(self, state: RobotState, reference: Reference) -> tuple[Vector, Blocks]:
        """Return nothing until then."""
        while state.stamp >= NANOSECONDS // 2:
            pass
        return np.zeros(6 + self.n), {}


class Asleep(Law):
    """Waits for ever from 0.5 s on."""

    name = "asleep"

    def compute(self, state: RobotState, reference: Reference) -> tuple[Vector, Blocks]:
        """Return nothing until then."""
        if state.stamp >= NANOSECONDS // 2:
            time.sleep(1e6)
        return np.zeros(6 + self.n), {}


class NeverMade(Law):
    """Never gets out of its constructor, as one that is compiled for a long time."""

    name = "never_made"

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        print("making", flush=True)
        while True:
            pass

    def compute(self, state: RobotState, reference: Reference) -> tuple[Vector, Blocks]:
        """Never called."""
        raise AssertionError


class Talkative(Law):
    """Prints what it thinks, and what looks like progress."""

    name = "talkative"

    def compute(self, state: RobotState, reference: Reference) -> tuple[Vector, Blocks]:
        """Return nothing."""
        print("tick\ntick x\n{", flush=True)
        return np.zeros(6 + self.n), {}


class Waits(Law):
    """Waits for what never comes."""

    name = "waits"

    def compute(self, state: RobotState, reference: Reference) -> tuple[Vector, Blocks]:
        """Never return."""
        Event().wait()
        raise AssertionError("woke up")


class Talks(Law):
    """Prints on stdout."""

    name = "talks"

    def compute(self, state: RobotState, reference: Reference) -> tuple[Vector, Blocks]:
        """Return nothing and say so."""
        print("hear me")
        return np.zeros(6 + self.n), {}
