"""One answer of the regulator, from state and reference to command and telemetry."""

from __future__ import annotations

from typing import Any, NamedTuple

from space_robot_control.kernel.answers import ANSWERED
from space_robot_control.laws.lqr.kernel.design import RegulatorRule
from space_robot_control.laws.lqr.kernel.regulator import RegulatorMemory, regulate, regulator_example, show
from space_robot_description.kernel.arrays import RobotArrays
from space_robot_description.kernel.context import kind_of, loaded, stored
from space_robot_description.kernel.jit import kernel
from space_robot_msgs_py.interfaces import Vector


class RegulatorContext(NamedTuple):
    """A law: its numbers, its memory, the nominal robot."""

    rule: RegulatorRule
    memory: RegulatorMemory
    robot: RobotArrays


REGULATOR = kind_of(RegulatorContext(*regulator_example()))


@kernel
def keep(values: Any, room: Any) -> int:
    """Write a context into bytes, see ``context_of``; returns how many it takes."""
    size: int = stored(values, room)
    return size


@kernel
def answer(
    context: Any,
    q: Vector,
    v: Vector,
    effort: Vector,
    acceleration: Vector,
    wheels: Vector,
    q_d: Vector,
    v_d: Vector,
    a_d: Vector,
    u: Vector,
    row: Vector,
) -> int:
    """See ``kernel.answers``; the blocks of ``row`` are those of ``Lqr``, in its order."""
    law = loaded(context, REGULATOR)
    status: int = regulate(law.rule, law.memory, law.robot, q, v, wheels, q_d, v_d, a_d, u)
    if status == ANSWERED:
        show(law.rule, law.memory, u, row)
    return status
