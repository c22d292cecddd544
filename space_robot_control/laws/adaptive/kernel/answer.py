"""One answer of the adaptive law, update included: what ``Adaptive`` does with the other kernels, without Python.

Where the law would raise an error the status says so, and nothing is said of why.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from space_robot_control.kernel.answers import ANSWERED, UNUSABLE
from space_robot_control.kernel.limits import fits
from space_robot_control.laws.adaptive.kernel.consistency import assess
from space_robot_control.laws.adaptive.kernel.control import control
from space_robot_control.laws.adaptive.kernel.euler import PITCH, coordinates
from space_robot_control.laws.adaptive.kernel.least_squares import correct, covariance_times, transpose_times
from space_robot_control.laws.adaptive.kernel.regression import regression
from space_robot_control.laws.adaptive.kernel.tree import Tree
from space_robot_control.laws.adaptive.kernel.workspace import PeriodStart, Rule, Workspace, workspace_for
from space_robot_description.kernel.context import kind_of, loaded, stored
from space_robot_description.kernel.jit import inner, kernel
from space_robot_msgs_py.interfaces import Vector


class UpdateRule(NamedTuple):
    """How the estimate is updated.

    Attributes:
        squares: 1: by least squares.
        filtered: 1: both sides of the regression behind a filter.
        tracks: 1: by (44).
        keep: of the filter, share of its past.
        step: period times gain of (44).
        gain: (P,) the same with the scale of the parameters; of updates without covariance.
        spread: (P,) standard deviation of the start.
        trace: of the covariance at the start.
        largest: trace at which it has blown up.
        threshold: surprise that is improbable.
        samples: improbable ones in a row that reset.
        pitch: largest [rad].
        gyroscopic: 1: the wheels' momentum is known.
    """

    squares: int
    filtered: int
    tracks: int
    keep: float
    step: float
    gain: npt.NDArray[np.float64]
    spread: npt.NDArray[np.float64]
    trace: float
    largest: float
    threshold: float
    samples: int
    pitch: float
    gyroscopic: int


class UpdateMemory(NamedTuple):
    """What the update remembers.

    Attributes:
        estimate: (P,) pi_hat.
        root: (P, P) square root of the covariance; (0, 0) without.
        counts: (5,) started, learned, improbable in a row, resets, consistent.
        numbers: (2,) surprise, trace of the covariance.
        innovation: (m,) scaled to unit noise, then as it is.
        start: of the present period.
        x: (6+n,) coordinates of the present state.
        dx: (6+n,) their rates.
        omega: (3,) body rate of the present state.
        wheels: (3,) their momentum as far as the law knows.
        tau: (6+n,) generalised force.
        rows: (m, P) filtered.
        values: (m,) filtered.
        pair: (2, P) scratch.
        gradient: (2, P) scratch.
    """

    estimate: npt.NDArray[np.float64]
    root: npt.NDArray[np.float64]
    counts: npt.NDArray[np.int64]
    numbers: npt.NDArray[np.float64]
    innovation: npt.NDArray[np.float64]
    start: PeriodStart
    x: npt.NDArray[np.float64]
    dx: npt.NDArray[np.float64]
    omega: npt.NDArray[np.float64]
    wheels: npt.NDArray[np.float64]
    tau: npt.NDArray[np.float64]
    rows: npt.NDArray[np.float64]
    values: npt.NDArray[np.float64]
    pair: npt.NDArray[np.float64]
    gradient: npt.NDArray[np.float64]


class Able(NamedTuple):
    """What a base command has to be within, see ``kernel.limits.fits``."""

    share: npt.NDArray[np.float64]
    torque: npt.NDArray[np.float64]
    force: npt.NDArray[np.float64]


class AdaptiveContext(NamedTuple):
    """A law: its numbers, its memory, the nominal robot."""

    tree: Tree
    rule: Rule
    update: UpdateRule
    able: Able
    work: Workspace
    memory: UpdateMemory
    order: npt.NDArray[np.int64]


STARTED, LEARNED, IMPROBABLE, RESETS, CONSISTENT = range(5)
SURPRISE, TRACE = range(2)


def update_memory(joints: int, actuated: int, *, squares: bool, filtered: bool) -> UpdateMemory:
    """Memory for that many joints and actuated degrees of freedom."""
    n, size = 6 + joints, 10 * (1 + joints)
    start = PeriodStart(np.zeros(n), np.zeros(n), np.zeros(3), np.zeros(3), np.zeros(6))
    root, rows = np.zeros((size, size) if squares else (0, 0)), np.zeros((actuated, size) if filtered else (0, 0))
    return UpdateMemory(
        estimate=np.zeros(size),
        root=root,
        counts=np.zeros(5, dtype=np.int64),
        numbers=np.zeros(2),
        innovation=np.zeros(actuated),
        start=start,
        x=np.zeros(n),
        dx=np.zeros(n),
        omega=np.zeros(3),
        wheels=np.zeros(3),
        tau=np.zeros(n),
        rows=rows,
        values=np.zeros(actuated),
        pair=np.zeros((2, size)),
        gradient=np.zeros((2, size)),
    )


def _example() -> AdaptiveContext:
    one, none, flags = np.zeros(1), np.zeros((1, 1)), np.zeros(1, dtype=np.int64)
    rule = Rule(0, 1.0, 1.0, 0, one, none, 0, one)
    update = UpdateRule(0, 0, 0, 1.0, 1.0, one, one, 1.0, 1.0, 1.0, 0, 1.0, 0)
    memory = update_memory(0, 6, squares=False, filtered=False)
    return AdaptiveContext(
        Tree(flags, flags, none), rule, update, Able(none, one, one), workspace_for(0, 0), memory, flags
    )


ADAPTIVE = kind_of(_example())


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
    """See ``kernel.answers``; the blocks of ``row`` are those of ``Adaptive``, in its order."""
    law = loaded(context, ADAPTIVE)
    update, memory, work = law.update, law.memory, law.work
    x, dx = memory.x, memory.dx
    coordinates(q, v, x, dx)
    if not abs(x[PITCH]) <= update.pitch:
        return UNUSABLE
    if not _observe(law, q, v, effort, acceleration):
        return UNUSABLE
    for k in range(3):
        memory.omega[k] = v[3 + k]
        memory.wheels[k] = wheels[k] if update.gyroscopic else 0.0
    estimate = memory.estimate
    value = control(law.tree, law.rule, estimate, x, dx, memory.omega, memory.wheels, q_d, v_d, a_d, work, u)
    _show(law, value, row)
    if update.tracks:
        gradient, change = memory.gradient[0], memory.gradient[1]
        transpose_times(work.Y, work.sigma_full, gradient)
        if update.squares:
            covariance_times(memory.root, gradient, memory.pair[0], change)
        for i in range(estimate.shape[0]):
            estimate[i] += update.step * change[i] if update.squares else update.gain[i] * gradient[i]
        return ANSWERED if _accept(memory) else UNUSABLE
    return ANSWERED


@kernel
def note(context: Any, u: Vector, middle: Vector, own: bool) -> int:
    """See ``kernel.answers``: the period that begins, under this command."""
    law = loaded(context, ADAPTIVE)
    memory, start = law.memory, law.memory.start
    for i in range(memory.x.shape[0]):
        start.x[i], start.dx[i] = memory.x[i], memory.dx[i]
    for k in range(3):
        start.omega[k] = memory.omega[k]
        start.wheels[k] = middle[k] if law.update.gyroscopic else 0.0
    for k in range(6):
        start.wrench[k] = u[k]
    memory.counts[STARTED] = 1
    return ANSWERED


@inner
def _observe(law: AdaptiveContext, q: Vector, v: Vector, effort: Vector, acceleration: Vector) -> bool:
    """RLS (39)-(41) on the period that ended in this state; False: the estimate is unusable."""
    update, memory, first = law.update, law.memory, law.rule.first
    memory.counts[LEARNED] = 0
    if not (update.squares and memory.counts[STARTED]):
        return True
    if not fits(law.able.share, law.able.torque, law.able.force, memory.start.wrench):
        for i in range(memory.innovation.shape[0]):
            memory.innovation[i] = 0.0
        return True
    estimate, start = memory.estimate, memory.start
    regression(
        law.tree, law.rule, estimate, start, memory.x, memory.dx, q, v, effort, acceleration, law.work, memory.tau
    )
    rows, values = law.work.Y[first:], memory.tau[first:]
    if update.filtered:
        _filter(update.keep, rows, values, memory)
        rows, values = memory.rows, memory.values
    surprise, trace, variances = correct(rows, values, memory.root, estimate, memory.innovation, memory.pair)
    for i in range(memory.innovation.shape[0]):
        memory.innovation[i] *= law.rule.noise[i]
    memory.numbers[SURPRISE], memory.numbers[TRACE] = surprise / values.shape[0], trace
    if not math.isfinite(variances + trace) or trace > update.largest:
        return False
    _watch(update, memory)
    memory.counts[LEARNED] = 1
    return _accept(memory)


@inner
def _filter(keep: float, rows: Vector, values: Vector, memory: UpdateMemory) -> None:
    for i in range(values.shape[0]):
        memory.values[i] = keep * memory.values[i] + (1.0 - keep) * values[i]
        for j in range(rows.shape[1]):
            memory.rows[i, j] = keep * memory.rows[i, j] + (1.0 - keep) * rows[i, j]


@inner
def _watch(update: UpdateRule, memory: UpdateMemory) -> None:
    """Reset the covariance on improbable data, several times in a row."""
    improbable = memory.numbers[SURPRISE] > update.threshold
    memory.counts[IMPROBABLE] = memory.counts[IMPROBABLE] + 1 if improbable else 0
    if memory.counts[IMPROBABLE] >= update.samples:
        memory.counts[IMPROBABLE] = 0
        memory.counts[RESETS] += 1
        memory.numbers[TRACE] = update.trace
        for i in range(memory.root.shape[0]):
            for j in range(memory.root.shape[0]):
                memory.root[i, j] = update.spread[i] if i == j else 0.0


@inner
def _accept(memory: UpdateMemory) -> bool:
    """False: the estimate is not finite, or without mass."""
    finite, mass, possible = assess(memory.estimate)
    memory.counts[CONSISTENT] = 1 if possible else 0
    return finite and not mass <= 0.0


@inner
def _show(law: AdaptiveContext, value: float, row: Vector) -> None:
    """Write the telemetry."""
    work, memory, order, size = law.work, law.memory, law.order, law.order.shape[0]
    for i in range(size):
        row[i], row[size + i] = work.e[order[i]], work.sigma[order[i]]
    at = 2 * size
    row[at] = value
    at += 1
    for i in range(memory.estimate.shape[0]):
        row[at + i] = memory.estimate[i]
    at += memory.estimate.shape[0]
    row[at] = float(memory.counts[CONSISTENT])
    at += 1
    if law.update.squares:
        for i in range(size):
            row[at + i] = memory.innovation[order[i]]
        at += size
        row[at], row[at + 1] = memory.numbers[SURPRISE], memory.numbers[TRACE]
        row[at + 2], row[at + 3] = float(memory.counts[RESETS]), float(memory.counts[LEARNED])
