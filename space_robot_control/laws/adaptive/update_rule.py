"""The numbers of an update of the estimate: the same ones for a law tick by tick and for compiled runs."""

from __future__ import annotations

from math import inf, radians

import numpy as np

from space_robot_control.laws.adaptive.gains import AdaptiveGains
from space_robot_control.laws.adaptive.kernel.answer import UpdateRule
from space_robot_control.laws.adaptive.least_squares import MAX_GROWTH
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.elementary import exp
from space_robot_msgs_py.kernel.products import dot


def update_rule(gains: AdaptiveGains, period: float, prior: Vector) -> UpdateRule:
    """The numbers of an update.

    Args:
        gains: of the law.
        period: control period [s].
        prior: (P,) parameters of the nominal robot.
    """
    size, rls, step = np.abs(prior), gains.rls, period * gains.tracking.gain
    spread = rls.prior_spread * size + rls.prior_floor
    trace = dot(spread, spread)
    return UpdateRule(
        squares=int(gains.update in ("rls", "rls_filtered", "composite")),
        filtered=int(gains.update == "rls_filtered"),
        tracks=int(gains.update in ("lyapunov", "composite")),
        keep=exp(-rls.bandwidth * period),
        step=step,
        gain=step * (size + gains.tracking.floor) * (size + gains.tracking.floor),
        spread=spread,
        trace=trace,
        largest=MAX_GROWTH * trace,
        threshold=inf if rls.reset is None else rls.reset.threshold,
        samples=1 if rls.reset is None else rls.reset.samples,
        pitch=radians(gains.pitch_limit_deg),
        gyroscopic=int(gains.gyroscopic),
    )
