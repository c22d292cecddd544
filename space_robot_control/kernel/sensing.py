"""Errors of named channels from one state and reference; the quantities are those of ``Sensing``."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from space_robot_control.kernel.gated_filter import (
    FilterMemory,
    FilterRule,
    filter_channel,
    filter_memory,
    restart_filter,
)
from space_robot_control.kernel.tracking import track
from space_robot_description.kernel.jit import inner, kernel
from space_robot_msgs_py.interfaces import Vector


class Errors(NamedTuple):
    """Room for the fields of ``TrackingErrors``."""

    configuration: npt.NDArray[np.float64]
    velocity: npt.NDArray[np.float64]
    feedforward: npt.NDArray[np.float64]
    quaternion: npt.NDArray[np.float64]


class SensingRule(NamedTuple):
    """What is looked at.

    Attributes:
        dofs: (m,) places of the channels in a velocity.
        filtered: 1: behind the filter.
        filter: its numbers; the period in any case.
    """

    dofs: npt.NDArray[np.int64]
    filtered: int
    filter: FilterRule


class SensingMemory(NamedTuple):
    """What is sensed, and what of it is remembered until the next tick.

    Attributes:
        begun: (1,) 1: there was a tick before.
        error: (m,) see ``Sensing``, and so the next five.
        rate: (m,).
        sample: (m,).
        moved: (m,).
        moved_sample: (m,).
        sped: (m,).
        seen: (m,) the error before the filter.
        desired: (m,) velocity of the reference.
        q: (7+n,) of the state.
        v: (6+n,) of the state.
        q_d: (7+n,) of the reference.
        filter: of the filter.
        now: errors of this tick.
        then: errors of the last state against the reference of this tick.
    """

    begun: npt.NDArray[np.int64]
    error: npt.NDArray[np.float64]
    rate: npt.NDArray[np.float64]
    sample: npt.NDArray[np.float64]
    moved: npt.NDArray[np.float64]
    moved_sample: npt.NDArray[np.float64]
    sped: npt.NDArray[np.float64]
    seen: npt.NDArray[np.float64]
    desired: npt.NDArray[np.float64]
    q: npt.NDArray[np.float64]
    v: npt.NDArray[np.float64]
    q_d: npt.NDArray[np.float64]
    filter: FilterMemory
    now: Errors
    then: Errors


def sensing_memory(joints: int, channels: int) -> SensingMemory:
    """Memory for that many joints and channels."""
    size = 6 + joints
    now, then = (Errors(np.zeros(size), np.zeros(size), np.zeros(size), np.zeros(4)) for _ in range(2))
    return SensingMemory(
        begun=np.zeros(1, dtype=np.int64),
        error=np.zeros(channels),
        rate=np.zeros(channels),
        sample=np.zeros(channels),
        moved=np.zeros(channels),
        moved_sample=np.zeros(channels),
        sped=np.zeros(channels),
        seen=np.zeros(channels),
        desired=np.zeros(channels),
        q=np.zeros(1 + size),
        v=np.zeros(size),
        q_d=np.zeros(1 + size),
        filter=filter_memory(channels),
        now=now,
        then=then,
    )


def restart_sensing(memory: SensingMemory) -> None:
    """Forget the past."""
    memory.begun[0] = 0
    for array in (memory.error, memory.rate, memory.sample, memory.moved, memory.moved_sample, memory.sped):
        array[:] = 0.0
    restart_filter(memory.filter)


@kernel
def sense(
    rule: SensingRule, memory: SensingMemory, q: Vector, v: Vector, q_d: Vector, v_d: Vector, a_d: Vector
) -> None:
    """Take the errors of one tick.

    Args:
        rule: of the channels.
        memory: read and written.
        q: (7+n,) of the state.
        v: (6+n,) of the state.
        q_d: (7+n,) of the reference.
        v_d: (6+n,) of the reference.
        a_d: (6+n,) of the reference.
    """
    _errors(memory.now, q, v, q_d, v_d, a_d)
    begun = memory.begun[0] == 1
    turned = begun and _differs(memory.q_d, q_d)
    if turned:
        # The last state against the new reference: exact for any chart of the attitude, also for a jump.
        _errors(memory.then, memory.q, memory.v, q_d, v_d, a_d)
    for i in range(rule.dofs.shape[0]):
        move = _chart(memory.then, rule.dofs[i]) - memory.seen[i] if turned else 0.0
        _channel(rule, memory, i, v[rule.dofs[i]], move, begun)
    for i in range(q.shape[0]):
        memory.q[i], memory.q_d[i] = q[i], q_d[i]
    for i in range(v.shape[0]):
        memory.v[i] = v[i]
    memory.begun[0] = 1


@inner
def _channel(rule: SensingRule, memory: SensingMemory, i: int, speed: float, move: float, begun: bool) -> None:
    """One channel at a speed, whose reference has moved since the last tick."""
    dof, error, rate, sample = rule.dofs[i], memory.error[i], memory.rate[i], memory.sample[i]
    seen = _chart(memory.now, dof)
    wanted = memory.now.velocity[dof] + speed
    memory.error[i], memory.rate[i], memory.sample[i] = seen, memory.now.velocity[dof], seen
    if rule.filtered:
        jump = move - 0.5 * rule.filter.period * (wanted + memory.desired[i]) if begun else 0.0
        filter_channel(rule.filter, memory.filter, i, seen, jump)
        found = memory.filter
        memory.error[i], memory.rate[i], memory.sample[i] = found.value[i], found.rate[i], found.sample[i]
    if begun:
        memory.moved[i] = move - (memory.error[i] - error)
        memory.moved_sample[i] = move - (memory.sample[i] - sample)
        memory.sped[i] = (wanted - memory.desired[i]) - (memory.rate[i] - rate)
    memory.seen[i], memory.desired[i] = seen, wanted


@inner
def _errors(out: Errors, q: Vector, v: Vector, q_d: Vector, v_d: Vector, a_d: Vector) -> None:
    track(q, v, q_d, v_d, a_d, out.configuration, out.velocity, out.feedforward, out.quaternion)


@inner
def _chart(errors: Errors, dof: int) -> float:
    """Error of a degree of freedom: 2 epsilon of the error quaternion for the attitude."""
    error: float = 2.0 * errors.quaternion[dof - 3] if 3 <= dof < 6 else errors.configuration[dof]
    return error


@inner
def _differs(a: Vector, b: Vector) -> bool:
    other = False
    for i in range(a.shape[0]):
        other = other or a[i] != b[i]
    return other
