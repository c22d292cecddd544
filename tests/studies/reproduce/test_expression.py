"""Conditions of claims: only numbers and comparisons, checked before a run, never more of Python."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from space_robot_msgs_py.errors import SpecError
from space_robot_studies.reproduce.expression import Condition, Formula

NAMES = ("late", "worst", "n1")
moderate = st.floats(-1e6, 1e6)


@given(moderate, moderate, moderate)
def test_a_condition_means_what_python_means(late: float, worst: float, n1: float) -> None:
    """Arithmetic, chained comparisons, and, or, not and the three functions give Python's own result."""
    values = {"late": late, "worst": worst, "n1": n1}
    for text in (
        "late < worst",
        "0 <= late <= worst < 1e3",
        "late + 2 * worst - n1 / 4 >= -worst",
        "not (late == worst) and (n1 != 0 or late > 1)",
        "abs(late) < max(worst, n1, 1) or min(late, n1) > +3",
    ):
        assert Condition(text, NAMES, "holds_if").holds(values) == eval(text, {}, values)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "late <",
        "late",
        "late + 1",
        "late and worst < 1",
        "(late < 1) + 1 < 2",
        "(late < 1) < 1",
        "late < 'a'",
        "late < True",
        "late < 1e999",
        "late in (1, 2)",
        "late is None",
        "late ** 2 < 1",
        "late.real < 1",
        "__import__('os').system('true') < 1",
        "abs(late, worst) < 1",
        "abs() < 1",
        "max(late) < 1",
        "max(*late) < 1",
        "max(late, key=worst) < 1",
        "[late for late in worst] < 1",
        "(lambda: 1)() < 1",
        "(x := 1) < 1",
        "late < 1 if worst else n1",
        "(" * 500 + "1" + ")" * 500,
    ],
)
def test_an_expression_beyond_comparisons_is_refused_unevaluated(text: str) -> None:
    """What is no comparison of numbers is one clear error that names the key."""
    with pytest.raises(SpecError, match=r"^claims\.0\.holds_if: "):
        Condition(text, NAMES, "claims.0.holds_if")


def test_an_unknown_name_suggests_the_nearest() -> None:
    """A misspelt measure is refused with the name that was meant."""
    with pytest.raises(SpecError, match=r"got 'wort'; accepted: worst"):
        Condition("wort < 1", NAMES, "holds_if")


@pytest.mark.parametrize("text", ["1 / late < 1", "1e308 * 10 * n1 > 1", "n1 - n1 * 1e308 * 10 < 1"])
def test_a_condition_that_has_no_value_is_an_arithmetic_error(text: str) -> None:
    """Division by zero and overflow are errors, never a verdict."""
    with pytest.raises(ArithmeticError):
        Condition(text, NAMES, "holds_if").holds({"late": 0.0, "worst": 1.0, "n1": 1.0})


@given(moderate, moderate)
def test_a_formula_means_what_python_means(late: float, worst: float) -> None:
    """Arithmetic and the three functions give Python's own number."""
    values = {"late": late, "worst": worst}
    for text in ("100 * (1 - late / 7)", "max(late, worst) - min(late, worst)", "-abs(late) + 2"):
        assert Formula(text, NAMES, "derived").value(values) == eval(text, {}, values)


@pytest.mark.parametrize("text", ["late < 1", "not late", "latest - 1", "late +", ""])
def test_a_bad_formula_is_refused_with_its_key(text: str) -> None:
    """A condition where a number is wanted, an unknown name or no expression at all is refused by its key."""
    with pytest.raises(SpecError, match="derived"):
        Formula(text, NAMES, "derived")
