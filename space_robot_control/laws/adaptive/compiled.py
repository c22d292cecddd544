"""The adaptive law for compiled runs, from its first state on."""

from __future__ import annotations

from math import exp, inf, radians

import numpy as np

from space_robot_control.command_limits import CommandLimits
from space_robot_control.laws.adaptive.cycle import Cycle
from space_robot_control.laws.adaptive.gains import AdaptiveGains
from space_robot_control.laws.adaptive.kernel.answer import (
    CONSISTENT,
    TRACE,
    Able,
    AdaptiveContext,
    UpdateRule,
    answer,
    keep,
    note,
    update_memory,
)
from space_robot_control.laws.adaptive.least_squares import MAX_GROWTH
from space_robot_control.laws.compiled import CompiledLaw, Layout
from space_robot_description.kernel.context import context_of
from space_robot_msgs_py.interfaces import Vector


def compiled_adaptive(
    cycle: Cycle, gains: AdaptiveGains, limits: CommandLimits, prior: Vector, *, consistent: bool
) -> CompiledLaw:
    """Return the law at its start; ``cycle.rule.k_d`` is the caller's to fill.

    Args:
        cycle: of a law that was just reset.
        gains: of the law, without projection.
        limits: of the nominal robot.
        prior: (P,) its parameters.
        consistent: every body with these parameters can exist.
    """
    squares, filtered = gains.update in ("rls", "rls_filtered", "composite"), gains.update == "rls_filtered"
    size, rls, step = np.abs(prior), gains.rls, cycle.rule.period * gains.tracking.gain
    spread = rls.prior_spread * size + rls.prior_floor
    trace = float(spread @ spread)
    update = UpdateRule(
        squares=int(squares),
        filtered=int(filtered),
        tracks=int(gains.update in ("lyapunov", "composite")),
        keep=exp(-rls.bandwidth * cycle.rule.period),
        step=step,
        gain=step * (size + gains.tracking.floor) ** 2,
        spread=spread,
        trace=trace,
        largest=MAX_GROWTH * trace,
        threshold=inf if rls.reset is None else rls.reset.threshold,
        samples=1 if rls.reset is None else rls.reset.samples,
        pitch=radians(gains.pitch_limit_deg),
        gyroscopic=int(gains.gyroscopic),
    )
    actuated = cycle.order.size
    memory = update_memory(prior.size // 10 - 1, actuated, squares=squares, filtered=filtered)
    memory.estimate[:] = prior
    memory.counts[CONSISTENT] = consistent
    if squares:
        memory.root[:] = np.diag(spread)
        memory.numbers[TRACE] = trace
    able = Able(*limits.base)
    context = AdaptiveContext(cycle.tree, cycle.rule, update, able, cycle.workspace, memory, cycle.order)
    return CompiledLaw(answer, context_of(context, keep), _layout(actuated, prior.size, squares=squares), note)


def _layout(actuated: int, parameters: int, *, squares: bool) -> Layout:
    joints = parameters // 10 - 1
    errors = {"position_error": 3, "euler_error": 3, "joint_error": joints}
    if actuated == 3 + joints:
        del errors["position_error"]
    blocks = {**errors, "sliding_variable": actuated, "lyapunov_function": 1, "parameters": parameters, "consistent": 1}
    if squares:
        blocks |= {"innovation": actuated, "surprise": 1, "covariance_trace": 1, "resets": 1, "learned": 1}
    return Layout.of(blocks)
