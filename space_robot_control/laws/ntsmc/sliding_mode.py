"""Terminal sliding mode for decoupled degrees of freedom: sliding variable, control, adapted gain, loop gain."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf

import numpy as np

from space_robot_control.laws.base import Review
from space_robot_control.laws.ntsmc.gains import SlidingGains
from space_robot_control.laws.ntsmc.kernel.sliding import ROWS, SlidingRule, adapt, slide
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.elementary import exp, power

Floats = Sequence[float]
# [m/s, rad/s]: the rate at which a DoF without an error of its own is taken to be disturbed by the others.
DISTURBED = 1e-2


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

    With ``clamp`` one held command may neither push s through zero nor e' past where a2 alone would bring it:

        |a3| <= |s| / (T (r/g) (|e'| + T |a3|)^(r-1)), on the right the a3 that is bounded
        a2 = (sign(e') max(0, |e'|^(r-1) - (g/r)(r-1) T)^(1/(r-1)) - e') / T   (not rotation),

    the latter being the mean over T of the former a2 along its own solution. Both vanish as T -> 0.

    Compiled: ``kernel/sliding.py``.

    Args:
        gains: of the law.
        gamma: (m,) Gamma.
        k2: (m,) K_2 [1/s2].
        rotation: which of the m are the rotation of the base.
        control_period: T [s].

    Attributes:
        rule: all of these numbers, for kernels.
        array: (m,) K_hat itself, which kernels change [m/s2, rad/s2].
        keep: share of K_hat that a period leaves [-].
        cap: largest K_hat [m/s2, rad/s2].

    Reference: [Giordano and Cenedese 2023, sec. IV].
    """

    def __init__(
        self, gains: SlidingGains, gamma: Floats, k2: Floats, rotation: Sequence[int], control_period: float
    ) -> None:
        exponents, adaptation, layer = gains.exponents, gains.adaptation, gains.boundary_layer
        size = len(gamma)
        self.rule = SlidingRule(
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
            edge=power(layer, exponents.reach - 1.0),
            half_norm_power=exponents.p1 / exponents.q1,
        )
        self._adaptation, self.keep = adaptation, exp(-adaptation.leak * control_period)
        self.cap = inf if adaptation.cap is None else adaptation.cap
        self.array = np.empty(size)
        self.reset()

    def reset(self) -> None:
        """Return to the initial K_hat."""
        self.array[:] = self._adaptation.initial

    def adopt(self, estimate: Vector) -> None:
        """Go on from a K_hat (m,) adapted with other gains [m/s2, rad/s2]."""
        self.array[:] = estimate

    @property
    def estimate(self) -> Vector:
        """(m,) K_hat [m/s2, rad/s2]."""
        return self.array.copy()

    def terms(self, e: Vector, rate: Vector, e_dot: Vector, speed_squared: float) -> Vector:
        """Return the terms of (28) with the present K_hat: (6, m), rows as ``kernel/sliding.py`` names them.

        S [m, rad], DELTA outside the boundary layer, (26) [m, rad], XI of (28c), EQUIVALENT a2 of (28b), which keeps s
        constant, REACHING a3 of (28c), which drives s to zero [m/s2, rad/s2], and LOOP_GAIN, see ``loop_gain`` [-].

        Args:
            e: (m,) error, actual minus desired [m, rad].
            rate: (m,) its rate, e' [m/s, rad/s]; for rotation the angular velocity error.
            e_dot: (m,) the derivative of e; differs from ``rate`` for rotation only.
            speed_squared: |x'|^2.
        """
        out = np.empty((ROWS, self.array.size))
        slide(self.rule, self.array, e, rate, e_dot, speed_squared, out)
        return out

    def adapt(self, xi: Vector, speed_squared: float, *, saturated: bool) -> None:
        """Integrate K_hat over one period, (29)."""
        if saturated and self._adaptation.freeze_on_saturation:
            return
        growth = self.rule.period * self._adaptation.rate * (1.0 + speed_squared)
        adapt(xi, growth, self.keep, self.cap, self.array)

    def gains_at(self, e: Floats, slowest: float) -> list[float]:
        """Return the loop gain (m,) at the edge of the boundary layer with the initial K_hat.

        Args:
            e: (m,) errors [m, rad]; each shrinks at |e'| = (g |e|)^(1/r) while s = 0, (11).
            slowest: least rate to assume [m/s, rad/s].
        """
        rule, (gamma, k2) = self.rule, self._per_dof()
        rates = [max(power(g * abs(x), 1.0 / rule.r), slowest) for g, x in zip(gamma, e, strict=True)]
        flat = self._adaptation.initial / rule.layer
        return [
            loop_gain(rule.period, rule.r, g, power(rate, rule.r - 1.0), flat + k * rule.reach * rule.edge)
            for rate, g, k in zip(rates, gamma, k2, strict=True)
        ]

    def cycle_rates(self) -> list[float]:
        """Return the rate (m,) of the cycle that K2 sustains in each DoF [m/s, rad/s]."""
        rule = self.rule
        return [cycle_rate(rule.period, rule.r, rule.reach, g, k) for g, k in zip(*self._per_dof(), strict=True)]

    def _per_dof(self) -> tuple[list[float], list[float]]:
        return self.rule.gamma.tolist(), self.rule.k2.tolist()


def review_loop_gain(
    sliding: SlidingMode, e: Floats, joint_names: Sequence[str], control_period: float, clamp: bool
) -> Review:
    """Return the loop gain per DoF at the edge of the boundary layer, and warn of chatter and of the cycle of K2.

    Args:
        sliding: with the law's gains.
        e: (m,) errors at the start; the gain is that at the rate they shrink at [m, rad].
        joint_names: the last n of the m.
        control_period: T [s].
        clamp: the law bounds the effect of one command, and there is no warning.
    """
    gain, cycle = sliding.gains_at(e, DISTURBED), sliding.cycle_rates()
    base = ("x", "y", "z", "rotation x", "rotation y", "rotation z")[6 - (len(e) - len(joint_names)) :]
    names = (*base, *joint_names)
    worst, fastest = (max(range(len(names)), key=numbers.__getitem__) for numbers in (gain, cycle))
    values = ", ".join(f"{name} {value:.2f}" for name, value in zip(names, gain, strict=True))
    period = f"at T = {control_period:g} s"
    facts = (f"loop gain {period} (above about 1 a DoF chatters): {values}",)
    if clamp:
        return Review(facts)
    warnings = []
    if gain[worst] > 1.0:
        longest = control_period / gain[worst]
        warnings.append(
            f"{names[worst]} chatters {period}: loop gain {gain[worst]:.2f}; clamp: true, or T up to {longest:.2g} s"
        )
    if cycle[fastest] > DISTURBED:
        warnings.append(
            f"{names[fastest]} may cycle at a rate of {cycle[fastest]:.2g} {period}: k2 is too large; clamp: true"
        )
    return Review(facts, tuple(warnings))


def loop_gain(control_period: float, r: float, gamma: float, root: float, slope: float) -> float:
    """Return how far one held command moves s, as a multiple of that s; above about 1 the loop chatters.

    From s' = (r/g) |e'|^(r-1) a3 and the slope of a3 in s:

        T (r/g) |e'|^(r-1) ( K_hat (1 + |x'|^2) / Phi + K2 (p2/q2) max(|Ds|, Phi)^(p2/q2 - 1) )

    Args:
        control_period: T [s].
        r: q/p [-].
        gamma: g of the DoF.
        root: |e'|^(r-1).
        slope: the bracket [1/s2].
    """
    return control_period * r / gamma * root * slope


def cycle_rate(control_period: float, r: float, reach: float, gamma: float, k2: float) -> float:
    """Return the rate |e'| of the cycle of two periods that the term K2 |Ds|^(p2/q2) sustains [m/s, rad/s].

    In it a held command takes e' from D to -D: 2 D = T K2 |s|^(p2/q2) with |s| about D^r / g, hence

        D = (T K2 / (2 g^(p2/q2)))^(1 / (1 - r p2/q2)).

    With the exponents of Table I the outer power is 20: the cycle is nothing below T = 2 g^(p2/q2) / K2 and beyond
    anything a robot can do above it. Chatter inside the boundary layer and of K_hat is not in it: see ``loop_gain``.

    Args:
        control_period: T [s].
        r: q/p [-].
        reach: p2/q2 [-].
        gamma: g of the DoF.
        k2: K2 of the DoF [1/s2].

    Returns:
        D; 0 for r p2/q2 >= 1, where such a cycle attracts nothing.
    """
    exponent = 1.0 - r * reach
    if exponent <= 0.0:
        return 0.0
    ratio = control_period * k2 / (2.0 * power(gamma, reach))
    # Past a hundred times the period the power would leave the range of floats.
    return power(min(ratio, 100.0), 1.0 / exponent)
