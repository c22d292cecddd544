"""Several runs in one call: plants in lanes, sensors and laws run by run; ``loop`` says the same of one run."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from space_robot_bringup.fused.kernel.loop import Body, Known, answered, passes
from space_robot_bringup.fused.kernel.records import Desired, Records
from space_robot_control.kernel.actuators import Actuators
from space_robot_control.kernel.wheels import Wheels
from space_robot_description.kernel.context import kind_of, loaded, stored
from space_robot_description.kernel.jit import inner, kernel
from space_robot_description.kernel.lanes import LANES
from space_robot_msgs_py.interfaces import Vector
from space_robot_sim.kernel.lanes import IDLE, LEFT
from space_robot_sim.kernel.period import plant_memory
from space_robot_sim.kernel.sensor_rule import SensorRule
from space_robot_sim.kernel.steps import DONE


class OneRun(NamedTuple):
    """What one run is made of besides the contexts of its plant and law; see ``loop.run_ticks``."""

    body: Body
    known: Known
    desired: Desired
    records: Records


def _example() -> OneRun:
    one, rows, whole = np.zeros(1), np.zeros((1, 1)), np.zeros(1, dtype=np.int64)
    body = Body(plant_memory(0, 0), SensorRule(whole, whole, whole, one, one, one), rows, rows, 0, 0, 0, rows)
    known = Known(Wheels(Actuators(one, rows, rows, 0.0), 0.0, 0, one, one, one), 0, one)
    return OneRun(body, known, Desired(rows, rows, rows), Records(rows, rows, rows, rows, rows, rows))


ONE_RUN = kind_of(_example())


class Crew(NamedTuple):
    """Addresses of the contexts of the runs, lane by lane; those of the first one again where there are fewer runs.

    Attributes:
        runs: (L,) of ``OneRun``.
        plants: (L,) of ``PlantContext``.
        laws: (L,) of what the laws work on.
        memory: of ``LaneMemory``.
    """

    runs: npt.NDArray[np.int64]
    plants: npt.NDArray[np.int64]
    laws: npt.NDArray[np.int64]
    memory: Any


@kernel
def keep_run(values: Any, room: Any) -> int:
    """Write a context into bytes, see ``context_of``; returns how many it takes."""
    size: int = stored(values, room)
    return size


@kernel
def run_lanes(
    crew: Crew,
    together: Any,
    advance: Any,
    answer: Any,
    note: Any,
    commands: Vector,
    status: npt.NDArray[np.int64],
    period: int,
    begin: int,
    end: int,
    reached: npt.NDArray[np.int64],
) -> None:
    """Run some ticks of several runs with the same law; one that fails leaves the others as they are.

    Args:
        crew: the runs.
        together: pointer to ``sim.kernel.lanes.advance_lanes``.
        advance: pointer to ``sim.kernel.period.advance``.
        answer: pointer to the function of the law, see ``control.kernel.answers``.
        note: likewise.
        commands: (L, 6+n) room.
        status: (L,) room.
        period: [ns].
        begin: first tick.
        end: tick after the last one.
        reached: (L,) -1: there is no such run, or it has failed before; else written: the first tick that is not
            whole, or ``end``.
    """
    for lane in range(LANES):
        reached[lane] = end if reached[lane] >= 0 else -1
    for tick in range(begin, end):
        if tick > 0:
            for lane in range(LANES):
                status[lane] = _ready(crew.runs[lane], commands[lane], tick) if reached[lane] == end else IDLE
            together(crew.plants, crew.memory, commands, period / 1e9, status)
            for lane in range(LANES):
                if status[lane] == LEFT:
                    status[lane] = advance(crew.plants[lane], commands[lane], period / 1e9, False)
        for lane in range(LANES):
            if reached[lane] == end and not (
                (tick == 0 or status[lane] == DONE)
                and _answered(crew.runs[lane], answer, note, crew.laws[lane], period, tick)
            ):
                reached[lane] = tick


@inner
def _ready(address: Any, command: Vector, tick: int) -> int:
    """Write the command that acts on the plant of a run until a tick; IDLE where the plant would change it."""
    run = loaded(address, ONE_RUN)
    if not passes(run.body.reach, run.records.command, tick - 1):
        return IDLE
    acted = tick - 1 - run.body.delay
    acting = run.records.command[acted] if acted >= 0 else run.known.zero
    for i in range(acting.shape[0]):
        command[i] = acting[i]
    return DONE


@inner
def _answered(address: Any, answer: Any, note: Any, law: Any, period: int, tick: int) -> bool:
    run = loaded(address, ONE_RUN)
    return answered(run.body, run.known, answer, note, law, run.desired, run.records, period, tick)
