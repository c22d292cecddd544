"""Where a sampled PD loop is stable: the closed form behind the check of bandwidth against control period."""

from __future__ import annotations

from math import inf


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
