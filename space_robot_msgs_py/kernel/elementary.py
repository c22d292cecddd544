"""Sine, exponential, power and the like from + - * / and square roots alone: equal bits on every machine.

Those of a system's library depend on its version, and on whether the processor multiplies and adds in one step. The
text is Python's and, where kernels call it, compiled (see ``jit``); without branches where lanes need it.

Error in units of the last place: below 1, of expm1 and atan2 below 1.5, of tanh 3; of powers 4 as long as they are
between 1e-20 and 1e20. Sine and cosine have it up to 1.6e6 rad; beyond, the angle is taken to its own last place.

References: Cody and Waite, "Software Manual for the Elementary Functions", 1980 (reduction of arguments); Dekker, "A
floating-point technique for extending the available precision", 1971 (sums and products of two numbers). Coefficients:
Chebyshev fits in 50 digits of (sin(x)/x - 1)/x^2 and the like, as powers.
"""

from __future__ import annotations

from collections.abc import Callable
from math import copysign, frexp, inf, ldexp, nan
from typing import Any

import numpy as np

# Adding and taking it away again rounds to an integer.
_ROUND = 6755399441055744.0
# Halves of the digits of a number, for exact products.
_SPLIT = 134217729.0
_TWO_OVER_PI, _LN2_INVERSE = 0.6366197723675814, 1.4426950408889634
# Sums of these are pi / 2 and ln 2; a product of all but the last with an integer up to 2^20 is exact.
_HALF_PI_1, _HALF_PI_2, _HALF_PI_3 = 1.5707963267341256, 6.077100506303966e-11, 2.0222662487959506e-21
_LN2_1, _LN2_2 = 0.6931471803691238, 1.9082149292705877e-10
_PI, _PI_REST = 3.141592653589793, 1.2246467991473532e-16
_SQRT_HALF, _TAN_PI_8 = 0.7071067811865476, 0.41421356237309503


def sincos(x: float) -> tuple[float, float]:
    """Sine and cosine of an angle [rad]; NaN where it is not finite."""
    n = (x * _TWO_OVER_PI + _ROUND) - _ROUND
    rest, part = x - n * _HALF_PI_1, n * _HALF_PI_2
    y = rest - part
    back = y - rest
    error = ((rest - (y - back)) - (part + back)) - n * _HALF_PI_3
    # Beyond 1e15 rad, where an angle says nothing, what is left is at least a sine.
    r = max(min(y + error, 0.8), -0.8)
    tail = max(min((y - r) + error, 1e-9), -1e-9)
    z = r * r
    odd = -2.50511122725732430e-08 + z * 1.5916726193889336e-10
    odd = 0.008333333333330827 + z * (-0.0001984126983657571 + z * (2.755731600817155e-06 + z * odd))
    s = r + (tail * (1.0 - 0.5 * z) + r * z * (-0.16666666666666666 + z * odd))
    even = -2.755731721268659e-07 + z * (2.0876134024090145e-09 + z * -1.1381754653662937e-11)
    even = 0.041666666666666664 + z * (-0.0013888888888887322 + z * (2.4801587298651292e-05 + z * even))
    most = 1.0 - 0.5 * z
    c = most + (((1.0 - most) - 0.5 * z) + (z * z * even - r * tail))
    # The quadrant, -2 to 2, without a branch: 1, 0, -1 times one and 0, 1 or -1 times the other.
    quadrant = n - 4.0 * ((0.25 * n + _ROUND) - _ROUND)
    size = abs(quadrant)
    own, other = 1.0 - size, size * (2.0 - size) * quadrant
    return own * s + other * c, own * c - other * s


def sin(x: float) -> float:
    """Sine of an angle [rad]."""
    return sincos(x)[0]


def cos(x: float) -> float:
    """Cosine of an angle [rad]."""
    return sincos(x)[1]


def atan2(y: float, x: float) -> float:
    """Angle of the point (x, y) [rad], -pi to pi, signs of zeros as in C."""
    across, along = abs(y), abs(x)
    large, small = max(across, along), min(across, along)
    if x != x or y != y:
        return nan
    if large > 1e300:
        # Their sum stays a number; of two that are infinite the angle is between them.
        small = 0.0 if small < large == inf else 0.25 * min(small, 1.7e308)
        large = 0.25 * min(large, 1.7e308)
    if small > _TAN_PI_8 * large:
        t, base, rest = (small - large) / (small + large), 0.25 * _PI, 0.25 * _PI_REST
    else:
        t, base, rest = small / large if large > 0.0 else 0.0, 0.0, 0.0
    angle = base + (rest + _arctangent(t))
    if across > along:
        angle = 0.5 * _PI - (angle - 0.5 * _PI_REST)
    if x < 0.0 or (large == 0.0 and copysign(1.0, x) < 0.0):
        angle = _PI - (angle - _PI_REST)
    return copysign(angle, y)


def atan2_rows(y: Any, x: Any) -> Any:
    """``atan2`` of arrays (m,) of numbers not below zero, up to 1e300."""
    large, small = np.maximum(x, y), np.minimum(x, y)
    steep, some = small > _TAN_PI_8 * large, large > 0.0
    t = np.divide(np.where(steep, small - large, small), np.where(steep, small + large, large), where=some, out=0.0 * x)
    angle = np.where(steep, 0.25 * _PI, 0.0) + (np.where(steep, 0.25 * _PI_REST, 0.0) + _arctangent(t))
    return np.where(y > x, 0.5 * _PI - (angle - 0.5 * _PI_REST), angle)


def power_of_two(n: float) -> float:
    """2^n of an integer from -1022 to 1023."""
    return ldexp(1.0, int(n))


def exp(x: float) -> float:
    """e^x."""
    return _exp_of(x, 0.0)


def expm1(x: float) -> float:
    """e^x - 1 for x up to 700, exact also near zero."""
    n, grown = _exp_reduced(max(min(x, 700.0), -50.0), max(-50.0, min(700.0, x)), 0.0)
    scale = power_of_two(n)
    return scale * grown + (scale - 1.0)


def tanh(x: float) -> float:
    """Hyperbolic tangent."""
    t = expm1(-2.0 * abs(x))
    # The sign without a branch; zero stays zero.
    sign = max(min(max(min(x, 1.0), -1.0) * 1e300, 1.0), -1.0)
    return sign * (t / (-2.0 - t))


def log(x: float) -> float:
    """Natural logarithm of a number above zero; NaN below, -inf at zero."""
    if not 0.0 < x < inf:
        return -inf if x == 0.0 else (inf if x == inf else nan)
    return _log_of(x)[0]


def power(x: float, y: float) -> float:
    """x^y of x not below zero; NaN below."""
    if y == 0.0:
        return 1.0
    if not 0.0 < x < inf:
        return nan if not x >= 0.0 or y != y else (0.0 if (x == 0.0) == (y > 0.0) else inf)
    high, low = _log_of(x)
    product = y * high
    return _exp_of(product, _lost(y, high, product) + y * low)


def _arctangent(t: Any) -> Any:
    """Of a number, or numbers, up to tan(pi/8)."""
    z = t * t
    p = 0.04551108126325172 + z * (-0.034558092551413795 + z * 0.01627194475162406)
    p = -0.06666423628069258 + z * (0.058789145444006215 + z * (-0.052303478730160745 + z * p))
    p = 0.11111111105106705 + z * (-0.09090908751076636 + z * (0.0769229630497447 + z * p))
    p = -0.3333333333333333 + z * (0.199999999999998 + z * (-0.14285714285659326 + z * p))
    return t + t * z * p


def _exp_of(x: float, low: float) -> float:
    """e^(x + low), low at most a few last places of x."""
    n, grown = _exp_reduced(max(min(x, 710.0), -746.0), max(-746.0, min(710.0, x)), low)
    half = (0.5 * n + _ROUND) - _ROUND
    return (1.0 + grown) * power_of_two(half) * power_of_two(n - half)


def _exp_reduced(x: float, number: float, low: float) -> tuple[float, float]:
    """N and e^r - 1 with x + low = n ln 2 + r; ``number`` is x, and a number also where x is none."""
    n = (number * _LN2_INVERSE + _ROUND) - _ROUND
    rest, part = x - n * _LN2_1, n * _LN2_2
    r = rest - part
    error = ((rest - r) - part) + low
    p = 2.755725283351691e-06 + r * (2.75572718102198e-07 + r * (2.5106274733573296e-08 + r * 2.0915442297780116e-09))
    p = 0.0013888888888883327 + r * (0.00019841269876864356 + r * (2.4801587327007187e-05 + r * p))
    p = 0.1666666666666667 + r * (0.04166666666666667 + r * (0.008333333333325544 + r * p))
    return n, r + (r * r * (0.5 + r * p) + (error + r * error))


def _log_of(x: float) -> tuple[float, float]:
    """Natural logarithm in two numbers, the second below the last place of the first."""
    m, e = frexp(x)
    k = float(e)
    if m < _SQRT_HALF:
        m, k = 2.0 * m, k - 1.0
    f = m - 1.0
    d = 2.0 + f
    s = f / d
    product = s * d
    rest = (((f - product) - _lost(s, d, product)) - s * ((2.0 - d) + f)) / d
    z = s * s
    p = 0.15386342974308154 + z * (0.1326603503726105 + z * 0.13114976096717038)
    p = 0.2857142857072283 + z * (0.2222222240984404 + z * (0.18181793722272505 + z * p))
    tail = s * z * (0.6666666666666666 + z * (0.4000000000000101 + z * p))
    high = k * _LN2_1 + 2.0 * s
    low = ((k * _LN2_1 - high) + 2.0 * s) + (2.0 * rest + (tail + k * _LN2_2))
    total = high + low
    return total, (high - total) + low


def _lost(a: float, b: float, product: float) -> float:
    """What rounding took from the product of two numbers (Dekker)."""
    wide, tall = a * _SPLIT, b * _SPLIT
    a1, b1 = wide - (wide - a), tall - (tall - b)
    a2, b2 = a - a1, b - b1
    return a2 * b2 - (((product - a1 * b1) - a2 * b1) - a1 * b2)


# What kernels may call, and what these call.
FUNCTIONS: tuple[Callable[..., Any], ...] = (sincos, sin, cos, atan2, power_of_two, exp, expm1, tanh, log, power)
FUNCTIONS += (_arctangent, _exp_of, _exp_reduced, _log_of, _lost)
