"""One answer of the model-free law, from state and reference to command and telemetry, once Phi(1) is known.

The symbols are those of ``ModelFree``.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from space_robot_control.kernel.answers import ANSWERED
from space_robot_control.kernel.gated_filter import FilterRule
from space_robot_control.kernel.sensing import SensingMemory, SensingRule, sense, sensing_memory
from space_robot_control.laws.mfac.kernel.gradient import (
    GradientMemory,
    GradientRule,
    foresee,
    gradient_memory,
    learn,
    pass_over,
)
from space_robot_control.laws.mfac.kernel.increment import IncrementMemory, IncrementRule, increment_memory, respond
from space_robot_description.kernel.context import kind_of, loaded, stored
from space_robot_description.kernel.jit import inner, kernel
from space_robot_msgs_py.interfaces import Vector


class LoopMemory(NamedTuple):
    """What stands between sensing, estimator and controller.

    Attributes:
        counts: (4,) answers, answers with a channel at its limit, whether there was one since Phi(1), whether the
            command that acts is the law's own.
        lead: (m,) c; 0: the output is the error.
        output: (m,) outputs of the law over SI.
        input: (m,) SI over inputs of the law.
        out: (m,) z.
        waiting: (d, m) increments of the input that do not act yet, the oldest first.
        response: (m,) diagonal of B behind Phi(1).
        deviation: (m,) of it, relative.
        error: (m,) of the law.
        dy: (m,) of the law.
        own: (m,) increment of the outputs by the robot's own motion.
        acted: (m,) increment of the input that acted.
    """

    counts: npt.NDArray[np.int64]
    lead: npt.NDArray[np.float64]
    output: npt.NDArray[np.float64]
    input: npt.NDArray[np.float64]
    out: npt.NDArray[np.float64]
    waiting: npt.NDArray[np.float64]
    response: npt.NDArray[np.float64]
    deviation: npt.NDArray[np.float64]
    error: npt.NDArray[np.float64]
    dy: npt.NDArray[np.float64]
    own: npt.NDArray[np.float64]
    acted: npt.NDArray[np.float64]


TICKS, SATURATED, BEGUN, OWN = range(4)


class MfacContext(NamedTuple):
    """A law: its numbers and its memory, part by part."""

    sensing: SensingRule
    sensed: SensingMemory
    estimator: GradientRule
    gradient: GradientMemory
    controller: IncrementRule
    increment: IncrementMemory
    loop: LoopMemory


def loop_memory(channels: int, delay: int) -> LoopMemory:
    """Memory for m channels and commands that act so many periods late."""
    return LoopMemory(
        counts=np.zeros(4, dtype=np.int64),
        lead=np.zeros(channels),
        output=np.zeros(channels),
        input=np.zeros(channels),
        out=np.zeros(channels),
        waiting=np.zeros((delay, channels)),
        response=np.zeros(channels),
        deviation=np.zeros(channels),
        error=np.zeros(channels),
        dy=np.zeros(channels),
        own=np.zeros(channels),
        acted=np.zeros(channels),
    )


def _example() -> MfacContext:
    one, square = np.zeros(1), np.zeros((1, 1))
    sensing = SensingRule(np.zeros(1, dtype=np.int64), 0, FilterRule(1.0, 1.0, 1.0, 0, one))
    estimator, controller = GradientRule(1, 1, 1.0, 1.0), IncrementRule(1, 1, square, one, one, one)
    memory = gradient_memory(1, 1, 1), increment_memory(1, 1, 1)
    return MfacContext(sensing, sensing_memory(0, 1), estimator, memory[0], controller, memory[1], loop_memory(1, 0))


MFAC = kind_of(_example())


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
    """See ``kernel.answers``; the blocks of ``row`` are those of ``ModelFree``, in its order."""
    law = loaded(context, MFAC)
    sense(law.sensing, law.sensed, q, v, q_d, v_d, a_d)
    _observe(law)
    loop = law.loop
    status = respond(law.controller, law.increment, law.gradient, loop.error, loop.dy)
    if status != ANSWERED:
        return status
    loop.counts[TICKS] += 1
    loop.counts[BEGUN] = 1
    beyond = False
    for i in range(u.shape[0]):
        u[i] = 0.0
    for i in range(loop.out.shape[0]):
        u[law.sensing.dofs[i]] = loop.input[i] * law.increment.command[i]
        beyond = beyond or law.increment.saturated[i]
    loop.counts[SATURATED] += 1 if beyond else 0
    _show(law, row)
    return ANSWERED


@kernel
def note(context: Any, u: Vector, middle: Vector, own: bool) -> int:
    """See ``kernel.answers``: the estimator leaves out periods under another law's command."""
    loaded(context, MFAC).loop.counts[OWN] = 1 if own else 0
    return ANSWERED


@inner
def _observe(law: MfacContext) -> None:
    """Let the estimator learn from the period that ended; write error and increment of the outputs for the law."""
    loop, sensed, begun = law.loop, law.sensed, law.loop.counts[BEGUN] == 1
    if begun:
        _take_increment(law.controller, law.increment, loop)
        usable = loop.counts[OWN] == 1
        for i in range(loop.out.shape[0]):
            loop.own[i] = loop.output[i] * (sensed.moved[i] + loop.lead[i] * sensed.sped[i])
            usable = usable and not sensed.filter.missing[i]
        if usable:
            learn(law.estimator, law.gradient, loop.own, loop.acted)
        else:
            pass_over(law.estimator, law.gradient, loop.acted)
    for i in range(loop.out.shape[0]):
        out = sensed.error[i] + loop.lead[i] * sensed.rate[i]
        # The first increment counts from zero error: a run starts as if its reference had just jumped.
        loop.dy[i] = -loop.output[i] * (out - loop.out[i])
        loop.error[i], loop.out[i] = loop.output[i] * out, out
    if begun and loop.waiting.shape[0] > 0:
        _predict(law)


@inner
def _take_increment(rule: IncrementRule, increment: IncrementMemory, loop: LoopMemory) -> None:
    """Write the increment of the input that acted; the last one waits as long as commands act late."""
    late = loop.waiting.shape[0]
    for i in range(loop.acted.shape[0]):
        newest = increment.past[rule.outputs, i]
        loop.acted[i] = loop.waiting[0, i] if late else newest
        for row in range(late):
            loop.waiting[row, i] = loop.waiting[row + 1, i] if row + 1 < late else newest


@inner
def _predict(law: MfacContext) -> None:
    """Error and change when the next command acts; Phi says what the present one does, the reference goes on."""
    loop = law.loop
    foresee(law.estimator, law.gradient, law.increment.past[law.controller.outputs], loop.acted)
    for i in range(loop.acted.shape[0]):
        change = loop.acted[i] + loop.dy[i] - loop.own[i]
        loop.error[i], loop.dy[i] = loop.error[i] - change, change


@inner
def _show(law: MfacContext, row: Vector) -> None:
    """Write the telemetry."""
    loop, sensed, gradient, size = law.loop, law.sensed, law.gradient, law.sensed.v.shape[0]
    m, first = loop.out.shape[0], law.loop.out.shape[0] * law.estimator.outputs
    for i in range(size):
        row[i], row[size + i] = sensed.now.configuration[i], sensed.now.velocity[i]
    at, refused = 2 * size, 0.0
    for i in range(m):
        row[at + i] = loop.out[i]
        for j in range(m):
            row[at + m + m * i + j] = gradient.estimate[i, first + j] / loop.output[i] / loop.input[j]
        row[at + m + m * m + i] = gradient.innovation[i]
        refused += sensed.filter.refused[i]
    at += 2 * m + m * m
    row[at], row[at + 1] = float(gradient.resets[0]), refused
    at += 2
    for i in range(m):
        row[at + i] = 1.0 if law.increment.saturated[i] else 0.0
        row[at + m + 2 + i], row[at + 2 * m + 2 + i] = loop.response[i], loop.deviation[i]
    row[at + m] = float(loop.counts[SATURATED]) / float(loop.counts[TICKS])
    row[at + m + 1] = 0.0
