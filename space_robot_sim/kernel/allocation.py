"""From a command to what the actuators do with it: limits, pulses, wheels that run full within the period."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from space_robot_description.kernel.jit import inner, kernel
from space_robot_msgs_py.interfaces import Vector
from space_robot_sim.kernel.rhs import BEGIN, END, FORCE, RATE, SEGMENT_SIZE, STORED, TORQUE


class Capability(NamedTuple):
    """What the actuators can do; channels are force(3), torque(3), joint efforts(n), as in a command.

    Attributes:
        limit: (6+n,) largest magnitude per channel; infinite where the channel does not act.
        acts: (6,) 1 where the base channel is driven from outside: no force when free-floating, no torque with wheels.
        pulsed: (6,) 1 where a base channel fires full pulses.
        minimum_pulse: (6,) shorter pulses are not fired [s].
        axes: (3, k) unit wheel axes, body frame.
        share: (k, 3) pseudo-inverse of the axes.
        wheel_limit: (k, 2) torque [N m] and momentum [N m s] of each wheel.
        preserve_direction: 1: one scale for the whole command instead of a clip per channel.
        disturbed: 1: what follows acts beside the command.
        push: (k,) torque on each wheel beside the commanded one [N m].
        outside: (6,) force and torque on the base from outside, body frame [N, N m].
    """

    limit: npt.NDArray[np.float64]
    acts: npt.NDArray[np.int64]
    pulsed: npt.NDArray[np.int64]
    minimum_pulse: npt.NDArray[np.float64]
    axes: npt.NDArray[np.float64]
    share: npt.NDArray[np.float64]
    wheel_limit: npt.NDArray[np.float64]
    preserve_direction: int
    disturbed: int
    push: npt.NDArray[np.float64]
    outside: npt.NDArray[np.float64]


class Allocation(NamedTuple):
    """What becomes of one command.

    Attributes:
        level: (6+k,) force(3), external torque(3), wheel momentum rates(k) while they last.
        stop: (6+k,) when each of them ends [s].
        segments: (7+k, 14) the same as intervals of constant action, see `kernel.rhs`.
        effort: (n,) joint efforts within the limits.
        wrench: (6,) mean force and torque on the base.
        saturated: (6+n,) 1 where a limit changed the channel.
    """

    level: npt.NDArray[np.float64]
    stop: npt.NDArray[np.float64]
    segments: npt.NDArray[np.float64]
    effort: npt.NDArray[np.float64]
    wrench: npt.NDArray[np.float64]
    saturated: npt.NDArray[np.float64]


def allocation(joints: int, wheels: int) -> Allocation:
    """Memory for one command."""
    return Allocation(
        np.zeros(6 + wheels),
        np.zeros(6 + wheels),
        np.zeros((7 + wheels, SEGMENT_SIZE)),
        np.zeros(joints),
        np.zeros(6),
        np.zeros(6 + joints),
    )


@kernel
def allocate(able: Capability, command: Vector, period: float, wheels: Vector, out: Allocation) -> int:
    """Decide what one period [s] under a command (6+n,) does, from wheel momenta (k,); returns the segments used."""
    scale = _common_scale(able, command) if able.preserve_direction else 1.0
    for channel in range(command.shape[0]):
        asked, limit = command[channel], able.limit[channel]
        out.saturated[channel] = 1.0 if abs(asked) > limit else 0.0
        given = max(-limit, min(limit, scale * asked))
        if channel < 6:
            out.level[channel] = given if able.acts[channel] else 0.0
        else:
            out.effort[channel - 6] = given
    for channel in range(6):
        out.stop[channel] = _pulse(able, channel, period, out.level)
    for wheel in range(wheels.shape[0]):
        _turn_wheel(able, wheel, scale, command, period, wheels[wheel], out)
    count = _cut(able, period, wheels, out)
    for k in range(3):
        out.wrench[k], out.wrench[3 + k] = 0.0, 0.0
        for row in range(count):
            part = (out.segments[row, END] - out.segments[row, BEGIN]) / period
            out.wrench[k] += part * out.segments[row, FORCE + k]
            out.wrench[3 + k] += part * (out.segments[row, TORQUE + k] - out.segments[row, RATE + k])
    return count


@inner
def _wheel_rate(able: Capability, wheel: int, command: Vector) -> float:
    """Momentum rate of a wheel whose reaction is its share of the commanded torque."""
    share = able.share
    rate: float = -(share[wheel, 0] * command[3] + share[wheel, 1] * command[4] + share[wheel, 2] * command[5])
    return rate


@inner
def _common_scale(able: Capability, command: Vector) -> float:
    """The largest number in [0, 1] by which the command fits every limit."""
    scale = 1.0
    for channel in range(command.shape[0]):
        size = abs(command[channel])
        if size > able.limit[channel]:
            scale = min(scale, able.limit[channel] / size)
    for wheel in range(able.share.shape[0]):
        size = abs(_wheel_rate(able, wheel, command))
        if size > able.wheel_limit[wheel, 0]:
            scale = min(scale, able.wheel_limit[wheel, 0] / size)
    return scale


@inner
def _pulse(able: Capability, channel: int, period: float, level: Vector) -> float:
    """End of the action of a base channel; a pulsed one fires fully for as long as gives the same impulse."""
    limit = able.limit[channel]
    if not able.pulsed[channel] or level[channel] == 0.0:
        return period
    length = min(1.0, abs(level[channel]) / limit) * period
    level[channel] = limit if level[channel] > 0.0 else -limit
    return length if length >= able.minimum_pulse[channel] else 0.0


@inner
def _turn_wheel(
    able: Capability, wheel: int, scale: float, command: Vector, period: float, stored: float, out: Allocation
) -> None:
    """Momentum rate of a wheel within its torque limit, and when it is full."""
    asked = _wheel_rate(able, wheel, command)
    torque, momentum = able.wheel_limit[wheel, 0], able.wheel_limit[wheel, 1]
    rate = max(-torque, min(torque, scale * asked))
    if able.disturbed:
        rate += able.push[wheel]
    stop = period
    if rate != 0.0:
        full = momentum if rate > 0.0 else -momentum
        stop = max(0.0, min(period, (full - stored) / rate))
    out.level[6 + wheel], out.stop[6 + wheel] = rate, stop
    if stop < period or abs(asked) > torque:
        for k in range(3):
            if abs(able.axes[k, wheel]) > 1e-9:
                out.saturated[3 + k] = 1.0


@inner
def _cut(able: Capability, period: float, wheels: Vector, out: Allocation) -> int:
    """Write the intervals between the ends of actions, in order; returns how many."""
    begin, count = 0.0, 0
    while begin < period:
        end = period
        for channel in range(out.stop.shape[0]):
            if begin < out.stop[channel] < end:
                end = out.stop[channel]
        row = out.segments[count]
        row[BEGIN], row[END] = begin, end
        for k in range(3):
            row[FORCE + k] = out.level[k] if out.stop[k] > begin else 0.0
            row[TORQUE + k] = out.level[3 + k] if out.stop[3 + k] > begin else 0.0
            row[RATE + k], row[STORED + k] = 0.0, 0.0
            for wheel in range(wheels.shape[0]):
                rate, stop = out.level[6 + wheel], out.stop[6 + wheel]
                row[RATE + k] += able.axes[k, wheel] * (rate if stop > begin else 0.0)
                row[STORED + k] += able.axes[k, wheel] * (wheels[wheel] + rate * min(begin, stop))
            if able.disturbed:
                row[FORCE + k] += able.outside[k]
                row[TORQUE + k] += able.outside[3 + k]
        begin, count = end, count + 1
    return count
