"""Terminal sliding mode for decoupled degrees of freedom: the sliding variable, what drives it, the adapted gain."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import copysign, exp

from space_robot_control.laws.ntsmc_gains import SlidingGains
from space_robot_control.laws.sliding_sampling import cycle_rate, loop_gain

Floats = Sequence[float]


@dataclass(frozen=True, slots=True)
class SlidingTerms:
    """What one update makes of the errors; every sequence (m,), one entry per controlled DoF.

    Attributes:
        s: sliding variable, (10), (14), (25) [m, rad].
        delta: s outside the boundary layer, (26) [m, rad].
        xi: of (28c).
        equivalent: a2 of (28b), keeps s constant [m/s2, rad/s2].
        reaching: a3 of (28c), drives s to zero [m/s2, rad/s2].
        loop_gain: see ``loop_gain`` [-].
    """

    s: Floats
    delta: Floats
    xi: Floats
    equivalent: Floats
    reaching: Floats
    loop_gain: Floats


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

    On Python floats: at fourteen numbers faster than on arrays.

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
        exponents, adaptation = gains.exponents, gains.adaptation
        self._gamma, self._k1, self._k2 = tuple(gamma), gains.k1, tuple(k2)
        self._layer, self._period, self._clamp = gains.boundary_layer, control_period, gains.clamp
        self._r, self._reach = exponents.rate, exponents.reach
        # The power of Delta s has no finite slope at 0; the layer's width is the least distance that means anything.
        self._edge = self._layer ** (self._reach - 1.0)
        self._half_norm_power = exponents.p1 / exponents.q1
        self._turning = [index in rotation for index in range(len(self._gamma))]
        self._adaptation, self._keep = adaptation, exp(-adaptation.leak * control_period)
        self.reset()

    def reset(self) -> None:
        """Forget what was adapted."""
        self._estimate = [self._adaptation.initial] * len(self._gamma)

    def adopt(self, estimate: Floats) -> None:
        """Go on from a K_hat (m,) that was adapted elsewhere [m/s2, rad/s2]."""
        self._estimate = list(estimate)

    @property
    def estimate(self) -> Floats:
        """(m,) K_hat [m/s2, rad/s2]."""
        return self._estimate

    def terms(self, e: Floats, rate: Floats, e_dot: Floats, speed_squared: float) -> SlidingTerms:
        """Return what (28) makes of the errors, with the present K_hat.

        Args:
            e: (m,) error, actual minus desired [m, rad].
            rate: (m,) its rate, e' [m/s, rad/s]; for rotation the angular velocity error.
            e_dot: (m,) the derivative of e; differs from ``rate`` for rotation only.
            speed_squared: |x'|^2.
        """
        surface = self._surface(e, rate)
        _, s, delta, xi = surface
        norm_squared, xi_squared = sum([d * d for d in delta]), sum([x * x for x in xi])
        along = self._k1 * norm_squared**self._half_norm_power / max(xi_squared, self._layer)
        reaching, gains = self._reaching(surface, rate, along, 1.0 + speed_squared)
        return SlidingTerms(s, delta, xi, self._equivalent(surface[0], rate, e_dot), reaching, gains)

    def adapt(self, xi: Floats, speed_squared: float, *, saturated: bool) -> None:
        """Move K_hat on by one period, (29)."""
        if saturated and self._adaptation.freeze_on_saturation:
            return
        growth, cap = self._period * self._adaptation.rate * (1.0 + speed_squared), self._adaptation.cap
        self._estimate = [(k + growth * abs(x)) * self._keep for k, x in zip(self._estimate, xi, strict=True)]
        if cap is not None:
            self._estimate = [min(k, cap) for k in self._estimate]

    def gains_at(self, e: Floats, slowest: float) -> list[float]:
        """Return the loop gain (m,) at the edge of the boundary layer with the initial K_hat.

        Args:
            e: (m,) errors [m, rad]; each shrinks at |e'| = (g |e|)^(1/r) while s = 0, (11).
            slowest: least rate to assume [m/s, rad/s].
        """
        rates = [max((g * abs(x)) ** (1.0 / self._r), slowest) for g, x in zip(self._gamma, e, strict=True)]
        flat = self._adaptation.initial / self._layer
        return [
            loop_gain(self._period, self._r, g, rate ** (self._r - 1.0), flat + k2 * self._reach * self._edge)
            for rate, g, k2 in zip(rates, self._gamma, self._k2, strict=True)
        ]

    def cycle_rates(self) -> list[float]:
        """Return the rate (m,) of the cycle that K2 sustains in each DoF [m/s, rad/s]."""
        return [
            cycle_rate(self._period, self._r, self._reach, g, k2) for g, k2 in zip(self._gamma, self._k2, strict=True)
        ]

    def _surface(self, e: Floats, rate: Floats) -> tuple[list[float], list[float], list[float], list[float]]:
        """|e'|^(r-1), s, Delta s and xi."""
        roots, surface, delta, xi = [], [], [], []
        power, layer = self._r - 1.0, self._layer
        for x, v, g in zip(e, rate, self._gamma, strict=True):
            root = abs(v) ** power
            weight = root / g
            s = weight * v + x
            d = s - layer if s > layer else s + layer if s < -layer else 0.0
            roots.append(root)
            surface.append(s)
            delta.append(d)
            xi.append(weight * d)
        return roots, surface, delta, xi

    def _reaching(
        self, surface: tuple[Floats, Floats, Floats, Floats], rate: Floats, along: float, grown: float
    ) -> tuple[list[float], list[float]]:
        """a3, and the loop gain."""
        reaching, gains = [], []
        layer, reach, edge, period, r = self._layer, self._reach, self._edge, self._period, self._r
        for root, s, d, x, v, k_hat, g, k2 in zip(*surface, rate, self._estimate, self._gamma, self._k2, strict=True):
            size, k = abs(d), k_hat * grown
            power = size**reach
            a3 = -(k * (copysign(1.0, s) if d else s / layer) + along * x + k2 * copysign(power, d))
            if self._clamp:
                push = abs(a3)
                moved = period * r / g * push * (abs(v) + period * push) ** (r - 1.0)
                if moved > abs(s):
                    a3 *= abs(s) / moved
            slope = k / layer + k2 * reach * (power / size if size > layer else edge)
            reaching.append(a3)
            gains.append(loop_gain(period, r, g, root, slope))
        return reaching, gains

    def _equivalent(self, roots: Floats, rate: Floats, e_dot: Floats) -> list[float]:
        """a2."""
        out, period, power = [], self._period, self._r - 1.0
        for root, v, x, g, turning in zip(roots, rate, e_dot, self._gamma, self._turning, strict=True):
            g_r = g / self._r
            if turning:
                out.append(-g_r * root / max(root * root, self._layer) * x)
            elif self._clamp:
                left = max(root - g_r * power * period, 0.0)
                out.append((copysign(left ** (1.0 / power), v) - v) / period)
            else:
                out.append(-g_r * v / root if root > 0.0 else 0.0)
        return out
