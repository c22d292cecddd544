"""Several compositions run side by side in one compiled call, where they fit each other; every run has its own bits."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from functools import cache
from typing import Any

import numpy as np

from space_robot_bringup.compose.composition import Composition
from space_robot_bringup.fused.kernel.lanes import ONE_RUN, Crew, OneRun, keep_run, run_lanes
from space_robot_bringup.fused.prepared import PreparedRun, pointers, prepared
from space_robot_bringup.fused.sink import FusedRun
from space_robot_description.kernel.context import Context, context_of, kind_of
from space_robot_description.kernel.jit import bound
from space_robot_description.kernel.lanes import LANES
from space_robot_msgs_py.errors import SpaceRobotError
from space_robot_sim.kernel.lanes import LaneMemory, advance_lanes, keep_lanes, lane_memory
from space_robot_sim.kernel.steps import DOP853, DOP853_CHECKED


def compiled_runs(compositions: Sequence[Composition], ticks: int | None = None) -> list[FusedRun | None]:
    """Run compositions side by side; see ``compiled_run``.

    Args:
        compositions: of the runs; those that differ in robot, law or ticks do not share a call.
        ticks: stop after so many; None: the whole runs.

    Returns:
        The runs in their order; None where one cannot be made or does not complete: alone it has the words for why.
    """
    runs = [_prepared(one, ticks) for one in compositions]
    groups: dict[Hashable, list[int]] = {}
    for index, run in enumerate(runs):
        if run is not None:
            groups.setdefault(_kind(run), []).append(index)
    done: list[FusedRun | None] = [None] * len(runs)
    for kind, members in groups.items():
        size = 1 if kind is None else LANES
        for begin in range(0, len(members), size):
            together = members[begin : begin + size]
            found = _completed([run for index in together if (run := runs[index]) is not None])
            for index, one in zip(together, found, strict=True):
                done[index] = one
    return done


def _prepared(composition: Composition, ticks: int | None) -> PreparedRun | None:
    try:
        return prepared(composition, ticks)
    except SpaceRobotError:
        return None


def _kind(run: PreparedRun) -> Hashable:
    """The same of runs that can share a call; None: of those that cannot share one."""
    _, context = run.body()
    robot, able, how, memory = context.values
    if how.method not in (DOP853, DOP853_CHECKED):
        return None
    shared = robot.tree, robot.motors, robot.coupling, able.axes, memory.disturbance
    times = run.period, run.ticks, run.changes, how.method, how.step, how.rtol, how.atol
    law = run.parts.compiled
    return *(array.tobytes() for array in shared), memory.y.size, memory.wheels.size, law.answer, law.note, *times


def _completed(runs: Sequence[PreparedRun]) -> list[FusedRun | None]:
    if len(runs) == 1:
        return [runs[0].completed()]
    group = _Group(runs)
    return group.completed() if group.fits else [run.completed() for run in runs]


class _Group:
    """Runs of one kind, at most ``LANES`` of them."""

    def __init__(self, runs: Sequence[PreparedRun]) -> None:
        self._runs, law, n = runs, runs[0].parts.compiled, runs[0].parts.law.n
        self._laws = [run.parts.compiled.context for run in runs]
        plant = runs[0].body()[1].values
        self._memory: LaneMemory = lane_memory(plant.memory, plant.robot.links.shape[0])
        self._room = context_of(self._memory, keep_lanes)
        self._reached = np.array([0 if lane < len(runs) else -1 for lane in range(LANES)], dtype=np.int64)
        self._calls = _calls(law.answer, law.note, n)
        self._space = np.zeros((LANES, 6 + n)), np.zeros(LANES, dtype=np.int64)
        # What compiled code finds by an address has to be what it takes it for; runs of one kind are alike in that.
        self.fits = kind_of(_one_run(runs[0])) == ONE_RUN

    def completed(self) -> list[FusedRun | None]:
        """The runs, done now; None: one fails."""
        for begin, end in self._runs[0].sections:
            for run in self._runs:
                run.switch_models(begin)
            self._run(begin, end)
            self._reached[self._reached != end] = -1
        return [run.result() if at >= 0 else None for run, at in zip(self._runs, self._reached.tolist(), strict=False)]

    def _run(self, begin: int, end: int) -> None:
        contexts = [context_of(_one_run(run), keep_run) for run in self._runs]
        plants = [run.body()[1] for run in self._runs]
        for lane in range(LANES):
            self._memory.links[..., lane] = plants[lane if lane < len(plants) else 0].values.robot.links
        runs, bodies, laws = map(_addresses, (contexts, plants, self._laws))
        crew = Crew(runs, bodies, laws, self._room.address)
        arguments = crew, *self._calls, *self._space, self._runs[0].period, begin, end, self._reached
        _code(*arguments)(*arguments)


def _one_run(run: PreparedRun) -> OneRun:
    return OneRun(run.body()[0], run.known, run.desired, run.records)


def _addresses(contexts: Sequence[Context]) -> Any:
    """Lane by lane; the first one again where there is none."""
    return np.array([contexts[lane if lane < len(contexts) else 0].address for lane in range(LANES)], dtype=np.int64)


@cache
def _calls(answer: Callable[..., Any], note: Callable[..., Any], joints: int) -> tuple[Any, ...]:
    """Pointers to what a call of several runs calls."""
    # Only here: without numba there is none.
    from space_robot_description.kernel.pointer import Pointer

    addresses, status = np.zeros(LANES, dtype=np.int64), np.zeros(LANES, dtype=np.int64)
    together = Pointer(advance_lanes, addresses, np.int64(0), np.zeros((LANES, 6 + joints)), 0.0, status)
    return together, *pointers(answer, note, joints)


_found: list[Callable[..., None]] = []


def _code(*arguments: Any) -> Callable[..., None]:
    """The machine code of the loop, which is the same for all plants and laws."""
    if not _found:
        _found.append(bound(run_lanes, *arguments))
    return _found[0]
