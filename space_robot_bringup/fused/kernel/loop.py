"""Plant, sensors and law tick by tick in one call; ``modes.headless`` says the same with values."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from space_robot_bringup.fused.kernel.records import Desired, Records
from space_robot_control.kernel.answers import ANSWERED
from space_robot_control.kernel.wheels import Wheels, apply_to_wheels
from space_robot_description.kernel.jit import inner, kernel
from space_robot_msgs_py.interfaces import Vector
from space_robot_sim.kernel.period import PlantMemory
from space_robot_sim.kernel.sensor_rule import SensorRule
from space_robot_sim.kernel.sensors import read_sensors
from space_robot_sim.kernel.steps import DONE


class Body(NamedTuple):
    """The true robot, see ``SimulatedRobot``.

    Attributes:
        memory: its state.
        sensors: what is seen of it.
        draws: (K, 15+2n) random numbers of the sensors; (1, ...) where they are ideal.
        limits: (2, n) of the joints.
        floating: 1: no force acts on its base.
        estimated: 1: the integration estimates its error.
        delay: periods by which a command acts late.
        reach: (2, 6+n) what of a command acts unchanged: its size, its change; beyond, the loop goes on.
    """

    memory: PlantMemory
    sensors: SensorRule
    draws: npt.NDArray[np.float64]
    limits: npt.NDArray[np.float64]
    floating: int
    estimated: int
    delay: int
    reach: npt.NDArray[np.float64]


class Known(NamedTuple):
    """What the flight software knows besides its law.

    Attributes:
        wheels: the nominal ones.
        delay: periods by which it takes commands to act late.
        zero: (6+n,) what acts before the first command does.
    """

    wheels: Wheels
    delay: int
    zero: npt.NDArray[np.float64]


@kernel
def run_ticks(
    body: Body,
    known: Known,
    advance: Any,
    plant: Any,
    answer: Any,
    note: Any,
    context: Any,
    desired: Desired,
    records: Records,
    period: int,
    begin: int,
    end: int,
) -> int:
    """Run some ticks; returns the first that is not whole, or ``end``.

    Args:
        body: the true robot, and what is recorded of it.
        known: to the flight software.
        advance: pointer to ``kernel.period.advance`` of the plant, which is compiled once for all runs.
        plant: its context.
        answer: pointer to the function of the law, see ``control.kernel.answers``.
        note: likewise.
        context: of the law.
        desired: reference of all ticks.
        records: written.
        period: [ns].
        begin: first tick.
        end: tick after the last one.
    """
    seconds = period / 1e9
    for tick in range(begin, end):
        if tick > 0:
            if not passes(body.reach, records.command, tick - 1):
                return tick
            acted = tick - 1 - body.delay
            command = records.command[acted] if acted >= 0 else known.zero
            if advance(plant, command, seconds, False) != DONE:
                return tick
        if not answered(body, known, answer, note, context, desired, records, period, tick):
            return tick
    return end


@inner
def answered(
    body: Body,
    known: Known,
    answer: Any,
    note: Any,
    context: Any,
    desired: Desired,
    records: Records,
    period: int,
    tick: int,
) -> bool:
    """Record a tick whose state the plant has reached, and the law's answer; False: it is not whole."""
    n = body.memory.motors.shape[0]
    _look(body, tick, records)
    _show(body, tick - 1 - body.delay, period, records, records.plant[tick])
    measured = records.measured[tick] if body.draws.shape[1] else records.truth[tick]
    q, v, acceleration = measured[: 7 + n], measured[7 + n : 13 + 2 * n], measured[13 + 2 * n :]
    u, row, wheels = records.command[tick], records.law[tick], known.wheels.momentum
    q_d, v_d, a_d = desired.q[tick], desired.v[tick], desired.a[tick]
    if answer(context, q, v, records.effort[tick], acceleration, wheels, q_d, v_d, a_d, u, row) != ANSWERED:
        return False
    if not (_finite(u) and _finite(row) and _finite(records.plant[tick]) and _finite(measured)):
        return False
    _note(known, note, context, tick, period / 1e9, records)
    return True


@inner
def _look(body: Body, tick: int, records: Records) -> None:
    """Record the truth, and what the sensors make of it."""
    memory, truth = body.memory, records.truth[tick]
    size = truth.shape[0] - 3
    for i in range(size):
        truth[i] = memory.y[i]
    for i in range(3):
        truth[size + i] = memory.gauges[4 + i]
    for i in range(memory.effort.shape[0]):
        records.effort[tick, i] = memory.effort[i]
    if body.draws.shape[1]:
        read_sensors(body.sensors, records.truth, tick, body.draws[tick], records.measured[tick])


@inner
def _show(body: Body, acted: int, period: int, records: Records, row: Vector) -> None:
    """Write the telemetry of the plant, in the order of ``PlantTelemetry``; the command of tick ``acted`` acted."""
    memory, n = body.memory, body.memory.motors.shape[0]
    at = _put(memory.y, 13 + 2 * n, row, 0)
    at = _put(memory.now, 7, row, at)
    at = _put(memory.gauges, 4, row, at)
    at = _put(memory.wheels, memory.wheels.shape[0], row, at)
    at = _put(memory.allocation.wrench, 6, row, at)
    at = _put(memory.effort, n, row, at)
    at = _put(memory.allocation.saturated, 6 + n, row, at)
    for i in range(n):
        x = memory.y[7 + i]
        row[at + i] = max(body.limits[0, i] - x, max(x - body.limits[1, i], 0.0))
    at += n
    row[at] = float(acted * period) if acted >= 0 else -1.0
    at += 1
    if body.floating:
        pushed = False
        for k in range(3):
            pushed = pushed or (acted >= 0 and records.command[acted, k] != 0.0)
        row[at] = 1.0 if pushed else 0.0
        at += 1
    if body.estimated:
        row[at] = memory.scratch.error[0]
        at += 1
    # Brakes close for want of a command, and here there is one every period.
    for i in range(at, row.shape[0]):
        row[i] = 0.0


@inner
def passes(reach: Vector, commands: Vector, tick: int) -> bool:
    """True if the plant takes a command unchanged."""
    fits = True
    for i in range(commands.shape[1]):
        fits = fits and not abs(commands[tick, i]) > reach[0, i]
        fits = fits and (tick == 0 or not abs(commands[tick, i] - commands[tick - 1, i]) > reach[1, i])
    return fits


@inner
def _put(values: Vector, count: int, row: Vector, at: int) -> int:
    for i in range(count):
        row[at + i] = values[i]
    return at + count


@inner
def _note(known: Known, note: Any, context: Any, tick: int, seconds: float, records: Records) -> None:
    """Let wheels and law take up the command that acts from now on, as far as the flight software knows."""
    acting = tick - known.delay
    command = records.command[acting] if acting >= 0 else known.zero
    apply_to_wheels(known.wheels, command, seconds)
    note(context, command, known.wheels.middle, acting >= 0)


@inner
def _finite(values: Vector) -> bool:
    whole = True
    for i in range(values.shape[0]):
        whole = whole and values[i] - values[i] == 0.0
    return whole
