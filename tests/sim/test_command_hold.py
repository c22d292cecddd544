"""Which command acts: the answer, an older one, or nothing; with and without a period of delay."""

from __future__ import annotations

import numpy as np
import pytest

from space_robot_msgs_py.errors import CommandError
from space_robot_msgs_py.interfaces import Command
from space_robot_sim.command_hold import NO_COMMAND, CommandHold
from space_robot_sim.spec import HoldFor

JOINTS = 2


def command(stamp: int) -> Command:
    return Command(stamp, np.full(6, float(stamp)), np.full(JOINTS, float(stamp)))


@pytest.mark.parametrize(
    ("hold", "delay", "acting"),
    [
        ("last", 0, [0, 0, 0, 3]),
        ("zero", 0, [0, NO_COMMAND, NO_COMMAND, 3]),
        ("last", 1, [NO_COMMAND, 0, 0, 0, 3]),
        ("zero", 1, [NO_COMMAND, 0, NO_COMMAND, NO_COMMAND, 3]),
    ],
)
def test_the_command_stamp_names_the_applied_command(hold, delay, acting):
    """Commands at 0 and 3, none in between: hold and delay decide, force and stamp agree."""
    line = CommandHold(JOINTS, delay_periods=delay, hold=hold)
    assert line.reset().stamp == NO_COMMAND
    given = [command(0), None, None, command(3), None][: len(acting)]
    for expected, now in zip(acting, given, strict=True):
        found = line.take(now)
        assert found.stamp == expected
        np.testing.assert_array_equal(found.u, np.full(6 + JOINTS, max(float(expected), 0.0)))


@pytest.mark.parametrize("periods", [1, 3])
def test_the_last_command_acts_for_so_many_periods(periods):
    """Without commands the last one acts for N periods, then nothing; a new command begins the count again."""
    line = CommandHold(JOINTS, delay_periods=0, hold=HoldFor(last_for=periods))
    for start in (1, 9):
        line.take(command(start))
        found = [line.take(None).stamp for _ in range(periods + 2)]
        assert found == [start] * periods + [NO_COMMAND] * 2


def test_a_reset_forgets_and_a_wrong_size_is_refused():
    """After a reset nothing is held; a command for another robot changes nothing."""
    line = CommandHold(JOINTS, delay_periods=0, hold="last")
    line.take(command(5))
    with pytest.raises(CommandError, match="wrong size"):
        line.take(Command(6, np.zeros(6), np.zeros(JOINTS + 1)))
    assert line.take(None).stamp == 5
    line.reset()
    assert line.take(None).stamp == NO_COMMAND


@pytest.mark.parametrize("brakes", [True, False])
def test_brakes_close_when_there_was_no_command_for_too_long(brakes):
    """At the first period behind those of the last command; a command or a reset opens them and counts from zero."""
    hold = CommandHold(2, delay_periods=0, hold=HoldFor(last_for=2, brakes=brakes))
    for _ in range(2):
        for begin in (lambda: hold.take(Command(5, np.ones(6), np.ones(2))), hold.reset):
            begin()
            assert hold.brakes is False
            closed = []
            for _ in range(4):
                hold.take(None)
                closed.append(hold.brakes)
            assert closed == [False, False, brakes, brakes]


def test_a_command_of_another_size_is_named():
    """With how many joints it is for, and how many there are."""
    hold = CommandHold(2, delay_periods=0, hold="zero")
    with pytest.raises(CommandError, match=r"command\.effort: wrong size; got 3; accepted: 2"):
        hold.take(Command(5, np.zeros(6), np.zeros(3)))
