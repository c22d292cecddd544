"""How fast a terminal sliding mode loop has to be sampled: its gain per period, and the cycle it ends in."""

from __future__ import annotations


def loop_gain(control_period: float, r: float, gamma: float, root: float, slope: float) -> float:
    """Return how far one held command moves s, as a multiple of the s it answers; above about 1 the loop chatters.

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
    power = 1.0 - r * reach
    if power <= 0.0:
        return 0.0
    ratio = control_period * k2 / (2.0 * gamma**reach)
    # Past a hundred times the period the power would leave the range of floats.
    return float(min(ratio, 100.0) ** (1.0 / power))
