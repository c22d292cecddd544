"""The gate in front of the plant."""

from __future__ import annotations

import numpy as np
import pytest

from space_robot_msgs_py.errors import CommandError
from space_robot_msgs_py.interfaces import Command
from space_robot_sim.gate import CommandGate


def test_lets_the_answer_through() -> None:
    """A command of the right size that answers the present state passes unchanged and is counted."""
    gate, command = CommandGate(3), Command(200, np.zeros(6), np.zeros(3))
    assert gate.check(command, 200) is command
    assert gate.counters == {"accepted": 1, "wrong_size": 0, "stale": 0, "future": 0}


@pytest.mark.parametrize(
    ("stamp", "joints", "counter", "message"),
    [
        (100, 3, "stale", r"command\.stamp: answers an earlier state; got 100; accepted: 200 ns"),
        (300, 3, "future", r"command\.stamp: answers a state to come; got 300; accepted: 200 ns"),
        (200, 2, "wrong_size", r"command\.effort: wrong size; got 2; accepted: 3 efforts"),
    ],
)
def test_refuses_and_counts(stamp: int, joints: int, counter: str, message: str) -> None:
    """A command that does not fit is an error that says why, and is counted by its kind."""
    gate = CommandGate(3)
    with pytest.raises(CommandError, match=message):
        gate.check(Command(stamp, np.zeros(6), np.zeros(joints)), 200)
    assert gate.counters == {"accepted": 0, "wrong_size": 0, "stale": 0, "future": 0} | {counter: 1}
