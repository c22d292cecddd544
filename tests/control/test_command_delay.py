"""Commands that act late, as the flight software knows of them."""

from __future__ import annotations

import numpy as np
import pytest

from space_robot_control.command_delay import NO_COMMAND, CommandDelay
from space_robot_msgs_py.interfaces import Command


@pytest.mark.parametrize("periods", [0, 1, 3])
def test_a_command_acts_so_many_periods_later_with_its_owner(periods: int) -> None:
    """Before the first one acts nothing does; after a reset again nothing."""
    delay = CommandDelay(periods, "none")
    commands = [Command(k, np.full(6, 1.0 + k), np.full(2, 1.0 + k)) for k in range(6)]
    for _ in range(2):
        for k, command in enumerate(commands):
            acting, owner = delay.acting(command, f"law {k}")
            if k < periods:
                assert (acting.stamp, owner) == (NO_COMMAND, "none")
                np.testing.assert_array_equal(acting.u, np.zeros(8))
            else:
                assert (acting, owner) == (commands[k - periods], f"law {k - periods}")
        delay.reset()
