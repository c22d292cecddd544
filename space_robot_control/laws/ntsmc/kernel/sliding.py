"""Terminal sliding mode of decoupled degrees of freedom; the symbols are those of ``SlidingMode``.

Reference: [Giordano and Cenedese 2023, sec. IV].
"""

from __future__ import annotations

from math import copysign
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from space_robot_description.kernel.jit import inner, kernel
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.elementary import power as power_of

# Rows of what ``slide`` writes.
S, DELTA, XI, EQUIVALENT, REACHING, LOOP_GAIN = range(6)
ROWS = 6


class SlidingRule(NamedTuple):
    """The sliding mode in numbers.

    Attributes:
        gamma: (m,) Gamma.
        k2: (m,) K_2 [1/s2].
        turning: (m,) 1 for the rotation of the base.
        k1: K_1 [1/s2].
        layer: Phi [m, rad].
        period: control period [s].
        clamp: 1: one held command is bounded.
        r: q/p.
        reach: p2/q2.
        edge: layer^(reach - 1).
        half_norm_power: p1/q1.
    """

    gamma: npt.NDArray[np.float64]
    k2: npt.NDArray[np.float64]
    turning: npt.NDArray[np.int64]
    k1: float
    layer: float
    period: float
    clamp: int
    r: float
    reach: float
    edge: float
    half_norm_power: float


@kernel
def slide(
    rule: SlidingRule,
    estimate: Vector,
    e: Vector,
    rate: Vector,
    e_dot: Vector,
    speed_squared: float,
    out: Vector,
) -> None:
    """Write s, Delta s, xi, a2, a3 and the loop gain, a row each.

    Args:
        rule: the gains.
        estimate: (m,) K_hat.
        e: (m,) error.
        rate: (m,) its rate.
        e_dot: (m,) its derivative.
        speed_squared: |x'|^2.
        out: (6, m) written.
    """
    norm_squared, xi_squared = 0.0, 0.0
    for i in range(e.shape[0]):
        weight = power_of(abs(rate[i]), rule.r - 1.0) / rule.gamma[i]
        s = weight * rate[i] + e[i]
        delta = s - rule.layer if s > rule.layer else s + rule.layer if s < -rule.layer else 0.0
        out[S, i], out[DELTA, i], out[XI, i] = s, delta, weight * delta
        norm_squared += delta * delta
        xi_squared += out[XI, i] * out[XI, i]
    along = rule.k1 * power_of(norm_squared, rule.half_norm_power) / max(xi_squared, rule.layer)
    for i in range(e.shape[0]):
        root = power_of(abs(rate[i]), rule.r - 1.0)
        out[EQUIVALENT, i] = _equivalent(rule, i, root, rate[i], e_dot[i])
        _reach(rule, i, root, rate[i], estimate[i] * (1.0 + speed_squared), along, out)


@kernel
def adapt(xi: Vector, growth: float, keep: float, cap: float, estimate: Vector) -> None:
    """K_hat one period on: K_hat <- min((K_hat + growth |xi|) keep, cap), every array (m,)."""
    for i in range(estimate.shape[0]):
        estimate[i] = min((estimate[i] + growth * abs(xi[i])) * keep, cap)


@inner
def _equivalent(rule: SlidingRule, i: int, root: float, v: float, e_dot: float) -> float:
    """a2."""
    slope, power = rule.gamma[i] / rule.r, rule.r - 1.0
    if rule.turning[i]:
        pull: float = -slope * root / max(root * root, rule.layer) * e_dot
        return pull
    if rule.clamp:
        left = max(root - slope * power * rule.period, 0.0)
        kept: float = power_of(left, 1.0 / power)
        return (copysign(kept, v) - v) / rule.period
    return -slope * v / root if root > 0.0 else 0.0


@inner
def _reach(rule: SlidingRule, i: int, root: float, v: float, k: float, along: float, out: Vector) -> None:
    """a3, and the loop gain."""
    s, delta, slope = out[S, i], out[DELTA, i], rule.r / rule.gamma[i]
    size = abs(delta)
    power = power_of(size, rule.reach)
    a3 = -(
        k * (copysign(1.0, s) if size > 0.0 else s / rule.layer)
        + along * out[XI, i]
        + rule.k2[i] * copysign(power, delta)
    )
    if rule.clamp:
        push = abs(a3)
        moved = rule.period * slope * push * power_of(abs(v) + rule.period * push, rule.r - 1.0)
        if moved > abs(s):
            a3 *= abs(s) / moved
    steepness = k / rule.layer + rule.k2[i] * rule.reach * (power / size if size > rule.layer else rule.edge)
    out[REACHING, i] = a3
    out[LOOP_GAIN, i] = rule.period * slope * root * steepness
