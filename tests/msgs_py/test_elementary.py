"""Elementary functions of our own: as exact as said, odd and even where they should be, the same bits compiled."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from space_robot_description.kernel import jit
from space_robot_msgs_py.kernel import elementary
from space_robot_msgs_py.kernel.elementary import atan2, atan2_rows, cos, exp, expm1, log, power, sin, sincos, tanh

RNG = np.random.default_rng(7)
WIDE = RNG.uniform(-700.0, 700.0, 3000).tolist()
SIGNED = (RNG.choice([-1.0, 1.0], 3000) * 10.0 ** RNG.uniform(-12.0, 2.0, 3000)).tolist()
POSITIVE = (10.0 ** RNG.uniform(-250.0, 250.0, 3000)).tolist()
# Zeros of sine and cosine, where only an exact reduction leaves any digit.
TURNS = [0.5 * math.pi * k for k in range(-2000, 2000)]
# In last places; what the library of mathematics is wrong by counts, too.
ONE = [
    (sin, math.sin, [*WIDE, *SIGNED, *TURNS], 1.5),
    (cos, math.cos, [*WIDE, *SIGNED, *TURNS], 1.5),
    (exp, math.exp, [*WIDE, *SIGNED], 1.5),
    (expm1, math.expm1, [x for x in [*WIDE, *SIGNED] if x > -50.0], 2.0),
    (tanh, math.tanh, SIGNED, 3.5),
    (log, math.log, [*POSITIVE, 5e-324, 1.0, 2.0], 1.5),
]


@pytest.mark.parametrize(("own", "library", "arguments", "places"), ONE, ids=[case[0].__name__ for case in ONE])
def test_functions_are_as_exact_as_said(
    own: Callable[[float], float], library: Callable[[float], float], arguments: list[float], places: float
) -> None:
    """Of thousands of arguments none is further from the library's value than a few last places."""
    for x in arguments:
        expected = library(x)
        assert abs(own(x) - expected) <= places * math.ulp(expected), x


def test_angles_of_points_are_as_exact_as_said() -> None:
    """In all quadrants, of points near both axes too, and with the signs of zeros."""
    for y, x in zip(SIGNED, reversed(SIGNED), strict=True):
        expected = math.atan2(y, x)
        assert abs(atan2(y, x) - expected) <= 2.0 * math.ulp(expected), (y, x)
    rows = np.abs(SIGNED), np.abs(SIGNED[::-1])
    np.testing.assert_array_equal(atan2_rows(*rows), [atan2(*pair) for pair in zip(*rows, strict=True)])
    np.testing.assert_array_equal(
        atan2_rows(np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0])), [0.0, 0.5 * math.pi, 0.0]
    )
    zeros = [(y, x) for y in (0.0, -0.0, 1.0, -1.0, math.inf) for x in (0.0, -0.0, 1.0, -1.0, math.inf, -math.inf)]
    for y, x in zeros:
        assert abs(atan2(y, x) - math.atan2(y, x)) <= math.ulp(math.atan2(y, x))
        assert math.copysign(1.0, atan2(y, x)) == math.copysign(1.0, math.atan2(y, x))


def test_powers_are_as_exact_as_said() -> None:
    """Also of roots and negative exponents; whole squares are exact."""
    for x, y in zip(10.0 ** RNG.uniform(-8.0, 4.0, 3000), RNG.uniform(-2.0, 3.0, 3000), strict=True):
        expected = math.pow(x, y)
        assert abs(power(float(x), float(y)) - expected) <= 5.0 * math.ulp(expected), (x, y)
    assert [power(x, 2.0) for x in (0.0, 1.0, 3.0, 1e10)] == [0.0, 1.0, 9.0, 1e20]
    assert power(0.0, -0.5) == power(math.inf, 0.5) == math.inf
    assert power(0.0, 0.0) == power(math.inf, 0.0) == 1.0


def test_what_is_no_number_stays_none() -> None:
    """NaN goes through, infinities have their limits, negative numbers no logarithm; no sine leaves [-1, 1]."""
    functions = (sin, cos, exp, expm1, tanh, log, lambda x: power(x, 0.5), lambda x: atan2(x, 1.0))
    assert all(math.isnan(function(math.nan)) for function in functions)
    assert [exp(-math.inf), exp(math.inf), exp(800.0), exp(-800.0)] == [0.0, math.inf, math.inf, 0.0]
    assert [tanh(-math.inf), tanh(math.inf), tanh(0.0), log(0.0)] == [-1.0, 1.0, 0.0, -math.inf]
    assert all(math.isnan(value) for value in (sin(math.inf), cos(-math.inf), log(-1.0), power(-1.0, 0.5)))
    assert all(abs(value) <= 1.0 for x in (1e10, 1e16, 1e22, 1e300) for value in sincos(x))


def test_symmetries_are_exact() -> None:
    """Sine and hyperbolic tangent are odd, the cosine even."""
    for x in [*SIGNED, *WIDE]:
        assert (sin(-x), cos(-x), tanh(-x)) == (-sin(x), cos(x), -tanh(x))


@pytest.mark.skipif(not jit.MACHINE_CODE, reason="compares compiled code with Python")
def test_compiled_code_has_the_same_bits() -> None:
    """Every function, over thousands of arguments: what it does here is what it does in a kernel."""
    from numba import njit

    one = (elementary.sin, elementary.cos, elementary.exp, elementary.expm1, elementary.tanh)
    x, positive = np.array([*SIGNED, *WIDE, *TURNS, math.nan, math.inf]), np.array([*POSITIVE, 0.0])

    @njit(error_model="numpy")  # type: ignore[untyped-decorator]
    def compiled(x: np.ndarray, positive: np.ndarray, out: np.ndarray, more: np.ndarray) -> None:
        for i in range(x.shape[0]):
            out[0, i], out[1, i], out[2, i] = sin(x[i]), cos(x[i]), exp(x[i])
            out[3, i], out[4, i] = expm1(x[i]), tanh(x[i])
        for i in range(positive.shape[0]):
            more[0, i], more[1, i] = log(positive[i]), power(positive[i], 0.3)
            more[2, i] = atan2(x[i], x[-3 - i])

    out, more = np.empty((5, x.size)), np.empty((3, positive.size))
    compiled(x, positive, out, more)
    for row, function in zip(out, one, strict=True):
        np.testing.assert_array_equal(row, [function(each) for each in x.tolist()], str(function))
    np.testing.assert_array_equal(more[0], [log(each) for each in positive.tolist()])
    np.testing.assert_array_equal(more[1], [power(each, 0.3) for each in positive.tolist()])
    backwards = x[-3 : -3 - positive.size : -1].tolist()
    np.testing.assert_array_equal(more[2], [atan2(*pair) for pair in zip(x.tolist(), backwards, strict=False)])
