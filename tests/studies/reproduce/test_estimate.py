"""Intervals: Wilson's for shares, a bootstrap for means, and arithmetic that is never too narrow."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from space_robot_studies.intervals import wilson
from space_robot_studies.reproduce.estimate import Estimate, bootstrap, exact, less, share_of
from space_robot_studies.reproduce.expression import Condition, Formula

WIDE = Estimate(1.0, 0.8, 1.3)


@pytest.mark.parametrize(("count", "of"), [(0, 1), (1, 1), (0, 20), (18, 20), (20, 20), (63, 100)])
def test_shares_have_the_interval_of_wilson(count: int, of: int) -> None:
    """The ends are those of an independent implementation, and of none or all of the runs 0 or 1 itself."""
    want = stats.binomtest(count, of).proportion_ci(method="wilson")
    assert wilson(count, of) == pytest.approx((want.low, want.high), abs=1e-12)
    assert format(share_of(count, of), "").startswith(f"{count} of {of} [")


def test_a_mean_has_the_interval_of_its_resamples() -> None:
    """It is near that of Student for many runs, the same every time, and of one run there is none."""
    values = np.random.default_rng(7).normal(5.0, 2.0, 100)
    found = bootstrap(values, np.mean)
    half = stats.t.ppf(0.975, 99) * values.std(ddof=1) / 10.0
    assert (found.low, found.value, found.high) == pytest.approx(
        (values.mean() - half, values.mean(), values.mean() + half), abs=0.1
    )
    assert found == bootstrap(values, np.mean)
    assert bootstrap(values[:1], np.mean).exact
    middle = bootstrap(values, np.median)
    assert middle.low < middle.value < middle.high


bounded = st.floats(-100.0, 100.0)


@given(st.tuples(bounded, bounded, bounded), st.tuples(bounded, bounded, bounded), st.floats(0.0, 1.0))
def test_arithmetic_of_intervals_holds_that_of_every_number_in_them(
    a: tuple[float, float, float], b: tuple[float, float, float], at: float
) -> None:
    """Whatever two numbers are inside the operands, the result for them is inside the result."""
    one, other = (Estimate(sorted(x)[1], min(x), max(x)) for x in (a, b))
    x, y = one.low + at * (one.high - one.low), other.high - at * (other.high - other.low)
    for text in ("a + b", "a - b", "a * b", "abs(a)", "min(a, b)", "max(a, -b)"):
        found = Formula(text, ("a", "b"), "k").estimate({"a": one, "b": other})
        assert found.low - 1e-9 <= eval(text, {}, {"a": x, "b": y}) <= found.high + 1e-9, text


def test_a_quotient_over_an_interval_with_zero_says_nothing() -> None:
    """Its interval is unbounded, so that no condition over it is decided."""
    found = Formula("1 / a", ("a",), "k").estimate({"a": Estimate(1.0, -1.0, 2.0)})
    assert (found.value, found.low, found.high) == (1.0, -np.inf, np.inf)
    assert Condition("1 / a > 0", ("a",), "k").holds({"a": Estimate(1.0, -1.0, 2.0)}) is None


@pytest.mark.parametrize(
    ("text", "truth"),
    [
        ("a < 2", True),
        ("a < 1.2", None),
        ("a > 2", False),
        ("a < 1.2 and 1 > 2", False),
        ("a < 1.2 or 1 < 2", True),
        ("not a < 1.2", None),
        ("0.5 < a < 2", True),
        ("a == 1", None),
        ("a == 9", False),
        ("a != 9", True),
        ("2 * a - a < 0.4", None),
    ],
)
def test_a_condition_is_open_where_the_interval_holds_the_bound(text: str, truth: bool | None) -> None:
    """True or false only where every number of the interval says so."""
    assert Condition(text, ("a",), "k").holds({"a": WIDE}) is truth


def test_numbers_are_written_with_their_intervals() -> None:
    """What is estimated shows its interval in the format that is asked for, what is counted that of its share."""
    assert f"{WIDE:.1f}" == "1.0 [0.8, 1.3]"
    assert f"{exact(2.0):.1f}" == "2.0"
    assert f"{Estimate(18.0, 18.0, 18.0, of=20)}" == "18 of 20 [70, 97 %]"
    assert less(exact(1.0), exact(1.0)) is False
