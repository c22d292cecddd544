"""Terminal sliding mode for decoupled degrees of freedom: the sliding variable, what drives it, the adapted gain."""

from __future__ import annotations

from collections.abc import Sequence
from math import exp, inf

import numpy as np

from space_robot_control.laws.ntsmc.gains import SlidingGains
from space_robot_control.laws.ntsmc.kernel.sliding import ROWS, SlidingRule, adapt, slide
from space_robot_control.laws.ntsmc.sliding_sampling import cycle_rate, loop_gain
from space_robot_description.kernel.jit import bound
from space_robot_msgs_py.interfaces import Vector

Floats = Sequence[float]


class SlidingMode:
    """a2 + a3 of (28) for m double integrators e'' = a, and the estimate K_hat of (29).

    With r = q/p, g = Gamma, and |.|, powers and products per DoF:

        s  = sign(e') |e'|^r / g + e                          (10), (14)
        Ds = s - Phi sat(s/Phi)                               (26)
        xi = |e'|^(r-1) / g Ds
        a2 = -(g/r) |e'|^(r-1) / max(|e'|^(2r-2), Phi) e_dot  (28b), rotation
        a2 = -(g/r) sign(e') |e'|^(2-r)                       (28b), the other DoFs, where e_dot = e'
        a3 = -[K_hat sat(s/Phi) (1 + |x'|^2) + k1 xi / max(|xi|^2, Phi) ||Ds||^(2 p1/q1) + K2 sign(Ds) |Ds|^(p2/q2)]
        K_hat' = phi |xi| (1 + |x'|^2)                        (29), forward Euler

    With ``clamp`` a held command may neither push s through zero nor e' past where a2 alone would bring it:

        |a3| <= |s| / (T (r/g) (|e'| + T |a3|)^(r-1)), on the right the a3 that is bounded
        a2 = (sign(e') max(0, |e'|^(r-1) - (g/r)(r-1) T)^(1/(r-1)) - e') / T   (not rotation),

    the latter being the mean over T of the former a2 along its own solution. Both vanish as T -> 0.

    Compiled: ``kernel.sliding``.

    Args:
        gains: of the law.
        gamma: (m,) Gamma.
        k2: (m,) K_2 [1/s2].
        rotation: which of the m are the rotation of the base.
        control_period: T [s].

    Reference: [Giordano and Cenedese 2023, sec. IV].
    """

    def __init__(
        self, gains: SlidingGains, gamma: Floats, k2: Floats, rotation: Sequence[int], control_period: float
    ) -> None:
        exponents, adaptation, layer = gains.exponents, gains.adaptation, gains.boundary_layer
        size = len(gamma)
        self._rule = SlidingRule(
            gamma=np.array(gamma, dtype=np.float64),
            k2=np.array(k2, dtype=np.float64),
            turning=np.array([index in rotation for index in range(size)], dtype=np.int64),
            k1=gains.k1,
            layer=layer,
            period=control_period,
            clamp=int(gains.clamp),
            r=exponents.rate,
            reach=exponents.reach,
            # The power of Delta s has no finite slope at 0; the layer's width is the least distance that means
            # anything.
            edge=layer ** (exponents.reach - 1.0),
            half_norm_power=exponents.p1 / exponents.q1,
        )
        self._adaptation, self._keep = adaptation, exp(-adaptation.leak * control_period)
        self._cap = inf if adaptation.cap is None else adaptation.cap
        self.reset()
        numbers, rows = np.zeros(size), np.zeros((ROWS, size))
        self._slide = bound(slide, self._rule, self._estimate, numbers, numbers, numbers, 0.0, rows)
        self._adapt = bound(adapt, numbers, 0.0, 0.0, 0.0, self._estimate)

    def reset(self) -> None:
        """Forget what was adapted."""
        self._estimate = np.full(self._rule.gamma.size, self._adaptation.initial)

    def adopt(self, estimate: Vector) -> None:
        """Go on from a K_hat (m,) that was adapted elsewhere [m/s2, rad/s2]."""
        self._estimate = np.array(estimate)

    @property
    def estimate(self) -> Vector:
        """(m,) K_hat [m/s2, rad/s2]."""
        return self._estimate.copy()

    def terms(self, e: Vector, rate: Vector, e_dot: Vector, speed_squared: float) -> Vector:
        """Return what (28) makes of the errors with the present K_hat: (6, m), rows as ``kernel.sliding`` names them.

        S [m, rad], DELTA outside the boundary layer, (26) [m, rad], XI of (28c), EQUIVALENT a2 of (28b), which keeps s
        constant, REACHING a3 of (28c), which drives s to zero [m/s2, rad/s2], and LOOP_GAIN, see ``loop_gain`` [-].

        Args:
            e: (m,) error, actual minus desired [m, rad].
            rate: (m,) its rate, e' [m/s, rad/s]; for rotation the angular velocity error.
            e_dot: (m,) the derivative of e; differs from ``rate`` for rotation only.
            speed_squared: |x'|^2.
        """
        out = np.empty((ROWS, self._estimate.size))
        self._slide(self._rule, self._estimate, e, rate, e_dot, speed_squared, out)
        return out

    def adapt(self, xi: Vector, speed_squared: float, *, saturated: bool) -> None:
        """Move K_hat on by one period, (29)."""
        if saturated and self._adaptation.freeze_on_saturation:
            return
        growth = self._rule.period * self._adaptation.rate * (1.0 + speed_squared)
        self._adapt(xi, growth, self._keep, self._cap, self._estimate)

    def gains_at(self, e: Floats, slowest: float) -> list[float]:
        """Return the loop gain (m,) at the edge of the boundary layer with the initial K_hat.

        Args:
            e: (m,) errors [m, rad]; each shrinks at |e'| = (g |e|)^(1/r) while s = 0, (11).
            slowest: least rate to assume [m/s, rad/s].
        """
        rule, (gamma, k2) = self._rule, self._per_dof()
        rates = [max((g * abs(x)) ** (1.0 / rule.r), slowest) for g, x in zip(gamma, e, strict=True)]
        flat = self._adaptation.initial / rule.layer
        return [
            loop_gain(rule.period, rule.r, g, rate ** (rule.r - 1.0), flat + k * rule.reach * rule.edge)
            for rate, g, k in zip(rates, gamma, k2, strict=True)
        ]

    def cycle_rates(self) -> list[float]:
        """Return the rate (m,) of the cycle that K2 sustains in each DoF [m/s, rad/s]."""
        rule = self._rule
        return [cycle_rate(rule.period, rule.r, rule.reach, g, k) for g, k in zip(*self._per_dof(), strict=True)]

    def _per_dof(self) -> tuple[list[float], list[float]]:
        return self._rule.gamma.tolist(), self._rule.k2.tolist()
