"""The adaptive law for compiled runs, from its first state on."""

from __future__ import annotations

import numpy as np

from space_robot_control.command_limits import CommandLimits
from space_robot_control.laws.adaptive.cycle import Cycle
from space_robot_control.laws.adaptive.gains import AdaptiveGains
from space_robot_control.laws.adaptive.kernel.answer import (
    CONSISTENT,
    TRACE,
    Able,
    AdaptiveContext,
    answer,
    keep,
    note,
    update_memory,
)
from space_robot_control.laws.adaptive.update_rule import update_rule
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
    update = update_rule(gains, cycle.rule.period, prior)
    squares, filtered = bool(update.squares), bool(update.filtered)
    actuated = cycle.order.size
    memory = update_memory(prior.size // 10 - 1, actuated, squares=squares, filtered=filtered)
    memory.estimate[:] = prior
    memory.counts[CONSISTENT] = consistent
    if squares:
        memory.root[:] = np.diag(update.spread)
        memory.numbers[TRACE] = update.trace
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
