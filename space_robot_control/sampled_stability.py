"""Where sampled loops are stable: the closed forms behind the checks of gains against the control period."""

from __future__ import annotations

from math import inf
from typing import Literal


def stability_margin(control_period: float, bandwidth: float, damping: float) -> float:
    """Return the factor by which the bandwidth can grow before a sampled PD loop on a double integrator is unstable.

    The loop x'' = u, u held over each period T at -kp x_k - kd v_k with kp = wn^2 and kd = 2 zeta wn, steps by

        A = [[1 - kp T^2/2, T - kd T^2/2], [-kp T, 1 - kd T]],
        trace A = 2 - kd T - kp T^2/2,   det A = 1 - kd T + kp T^2/2.

    Jury's conditions for both eigenvalues inside the unit circle are 1 - trace + det = kp T^2 > 0, always met;
    1 + trace + det = 4 - 2 kd T > 0, that is zeta wn T < 1; and det < 1, that is wn T < 4 zeta. Hence the loop is
    stable if and only if wn T < min(1/zeta, 4 zeta); no damping allows more than wn T = 2 (at zeta = 1/2).

    The plant is a double integrator for constant inertia and no computation delay; with a delay of one period, or an
    inertia that the nominal model misses, keep the margin at 3 or more.

    Args:
        control_period: T [s], positive.
        bandwidth: natural frequency wn [rad/s]; 0 has infinite margin.
        damping: damping ratio zeta [-], positive.

    Returns:
        min(1/zeta, 4 zeta) / (wn T); stable if and only if above 1.

    Reference: Jury, "Theory and Application of the z-Transform Method", 1964, ch. 3.
    """
    product = bandwidth * control_period
    return min(1.0 / damping, 4.0 * damping) / product if product > 0.0 else inf


def stable_lambda(
    control_period: float, decay: float, *, on: Literal["position", "velocity"] = "position", lead: bool = False
) -> tuple[float, float]:
    """Return the open interval of Lambda in which the sampled Slotine-Li loop is stable; empty if low >= high.

    With exact parameters and a held command each mode of M^-1 K_D, of rate d, obeys x'' = -kd x_k' - kp x_k with

        lambda_on position: kd = d + Lambda, kp = d Lambda;    velocity: kd = d Lambda, kp = d,

    and ``lead`` adds kp T/2 to kd. Jury's conditions (see ``stability_margin``) are kd T < 2 and kp T < 2 kd. For
    position and no lead that is T (d + Lambda) < 2, the second condition following from the first; the fastest mode
    decides. For velocity without lead it is d T Lambda < 2 and T < 2 Lambda.

    Exact for constant M and one Lambda for all degrees of freedom; with several, the smallest and largest have to be
    inside. A delay of a period is not in it.

    Args:
        control_period: T [s].
        decay: lambda_max(M^-1 K_D), the largest along the path [1/s; velocity: 1/s2].
        on: which error Lambda weighs.
        lead: the law looks half a period ahead.
    """
    t, d = control_period, decay
    if on == "position":
        return 0.0, (2.0 / t - d) / (1.0 + 0.5 * d * t) if lead else 2.0 / t - d
    return (0.0, 2.0 / (d * t) - 0.5 * t) if lead else (0.5 * t, 2.0 / (d * t))
