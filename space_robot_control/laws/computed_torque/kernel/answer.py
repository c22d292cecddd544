"""One answer of computed torque, from state and reference to command and telemetry.

The whole of a compiled law is here: numbers, memory, and one function of them; see ``kernel.answers``.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from space_robot_control.kernel.answers import ANSWERED, UNUSABLE
from space_robot_control.kernel.nominal import actuated_forces, add_gyroscopic
from space_robot_control.kernel.tracking import track
from space_robot_description.kernel.arrays import RobotArrays
from space_robot_description.kernel.context import kind_of, loaded, stored
from space_robot_description.kernel.inverse_dynamics import MOTION_SIZE
from space_robot_description.kernel.jit import kernel
from space_robot_msgs_py.interfaces import Vector


class TorqueRule(NamedTuple):
    """The numbers of the law.

    Attributes:
        kp: (6+n,) Kp [1/s2].
        kd: (6+n,) Kd [1/s].
        mass: of the nominal robot [kg].
        floating: 1: no force acts on the base.
        gyroscopic: 1: omega x h of the wheels is part of the command.
    """

    kp: npt.NDArray[np.float64]
    kd: npt.NDArray[np.float64]
    mass: float
    floating: int
    gyroscopic: int


class TorqueMemory(NamedTuple):
    """What one answer is made of: tracking errors, a, and work of the inverse dynamics."""

    configuration: npt.NDArray[np.float64]
    velocity: npt.NDArray[np.float64]
    feedforward: npt.NDArray[np.float64]
    quaternion: npt.NDArray[np.float64]
    acceleration: npt.NDArray[np.float64]
    work: npt.NDArray[np.float64]


class TorqueContext(NamedTuple):
    """A law: its numbers, its memory, the nominal robot."""

    rule: TorqueRule
    memory: TorqueMemory
    robot: RobotArrays


def torque_memory(joints: int, followers: int = 0) -> TorqueMemory:
    """Memory for that many joints, and others that follow them."""
    size = 6 + joints
    dof = np.zeros(size), np.zeros(size), np.zeros(size)
    return TorqueMemory(*dof, np.zeros(4), np.zeros(size), np.zeros((1 + joints + followers, MOTION_SIZE)))


def _example() -> TorqueContext:
    one, none = np.zeros(1), np.zeros((1, 1))
    robot = RobotArrays(np.zeros((1, 3), dtype=np.int64), none, none)
    return TorqueContext(TorqueRule(one, one, 1.0, 0, 0), torque_memory(0), robot)


TORQUE = kind_of(_example())


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
    """See ``kernel.answers``; the blocks of ``row`` are those of ``ComputedTorque``, in its order."""
    law = loaded(context, TORQUE)
    rule, memory, size = law.rule, law.memory, v.shape[0]
    track(q, v, q_d, v_d, a_d, memory.configuration, memory.velocity, memory.feedforward, memory.quaternion)
    wanted = memory.acceleration
    for i in range(size):
        wanted[i] = memory.feedforward[i] + rule.kd[i] * memory.velocity[i] + rule.kp[i] * memory.configuration[i]
    if not actuated_forces(law.robot, rule.mass, rule.floating, q, v, wanted, memory.work, u):
        return UNUSABLE
    if rule.gyroscopic:
        add_gyroscopic(wheels, v, u)
    for i in range(size):
        row[i], row[size + i], row[2 * size + i] = memory.configuration[i], memory.velocity[i], wanted[i]
    return ANSWERED
