"""How compiled laws are called: two functions of one signature each, whatever the law.

``answer(context, q, v, effort, acceleration, wheels, q_d, v_d, a_d, u, row)`` answers one state and returns a status:

    context: of the law, see ``description.kernel.context``: its gains, memory and nominal robot.
    q, v: (7+n,), (6+n,) measured.
    effort, acceleration: (n,), (3,) measured.
    wheels: (3,) momentum of the nominal wheels, body frame [N m s].
    q_d, v_d, a_d: (7+n,), (6+n,), (6+n,) of the reference.
    u: (6+n,) written: the command.
    row: written: the telemetry, block by block.

``note(context, u, middle, own)`` takes note of the command that acts from now on, of the wheels' momentum in the middle
of its period, and of whether it is the law's own.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from space_robot_description.kernel.jit import kernel
from space_robot_msgs_py.interfaces import Vector

ANSWERED, UNUSABLE = 0, 1


def answer_example(joints: int, telemetry: int) -> tuple[Any, ...]:
    """Arguments of ``answer`` after the context, of the types that all laws are compiled for."""
    q, v = np.zeros(7 + joints), np.zeros(6 + joints)
    three = np.zeros(3)
    return q, v, np.zeros(joints), three, three, q, v, v, np.zeros(6 + joints), np.zeros(telemetry)


@kernel
def ignore(context: Any, u: Vector, middle: Vector, own: bool) -> int:
    """``note`` of a law that remembers no command."""
    return ANSWERED
