"""Conditions and formulas over named numbers: arithmetic, comparisons, and/or/not, and nothing else of Python."""

from __future__ import annotations

import ast
import operator
from collections.abc import Callable, Collection, Iterable, Mapping
from math import isfinite
from typing import Any

from space_robot_description.validation import nearest
from space_robot_msgs_py.errors import SpecError
from space_robot_studies.reproduce.estimate import Estimate, absolute, equal, exact, extreme, less

ARITHMETIC: dict[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
}
# True, False, or None where the intervals do not decide.
Truth = bool | None
COMPARISONS: dict[type[ast.cmpop], Callable[[Estimate, Estimate], Truth]] = {
    ast.Lt: less,
    ast.LtE: lambda a, b: _not(less(b, a)),
    ast.Gt: lambda a, b: less(b, a),
    ast.GtE: lambda a, b: _not(less(a, b)),
    ast.Eq: equal,
    ast.NotEq: lambda a, b: _not(equal(a, b)),
}
FUNCTIONS: dict[str, Callable[..., Estimate]] = {
    "abs": absolute,
    "min": lambda *numbers: extreme(min, *numbers),
    "max": lambda *numbers: extreme(max, *numbers),
}
ACCEPTED = "numbers, names of measures, + - * /, < <= > >= == !=, and, or, not, abs, min, max"


class _Expression:
    """Checked once, evaluated on numbers.

    Args:
        text: the expression.
        names: the numbers it may name.
        key: dotted key for errors.

    Raises:
        SpecError: it is not what it should be, or not over these names.
    """

    def __init__(self, text: str, names: Collection[str], key: str) -> None:
        self._text, self._names, self._key = text, names, key
        try:
            self._tree = ast.parse(text.strip(), mode="eval").body
        except (SyntaxError, ValueError, RecursionError, MemoryError):
            raise self._refusal("not an expression", text) from None
        self._check()

    def _check(self) -> None:
        """Refuse what has not the type it should have."""

    def _is_truth(self, node: ast.expr) -> bool:
        """Whether a node is a condition (else a number); everything below it is checked."""
        if isinstance(node, ast.BoolOp):
            return self._all(node.values, truth=True)
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
            return self._all([node.operand], truth=True)
        if isinstance(node, ast.Compare) and all(type(op) in COMPARISONS for op in node.ops):
            return self._all([node.left, *node.comparators], truth=False)
        self._check_number(node)
        return False

    def _check_number(self, node: ast.expr) -> None:
        if isinstance(node, ast.BinOp) and type(node.op) in ARITHMETIC:
            self._all([node.left, node.right], truth=False)
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.UAdd):
            self._all([node.operand], truth=False)
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in FUNCTIONS:
            fits = len(node.args) == 1 if node.func.id == "abs" else len(node.args) >= 2
            if not fits or node.keywords or any(isinstance(argument, ast.Starred) for argument in node.args):
                raise self._refusal("wrong arguments", ast.unparse(node), "abs(a), min(a, b, ...), max(a, b, ...)")
            self._all(node.args, truth=False)
        elif isinstance(node, ast.Name):
            if node.id not in self._names:
                accepted = nearest(node.id, self._names) or ", ".join(self._names)
                raise self._refusal("no such measure", node.id, accepted)
        elif not (isinstance(node, ast.Constant) and _is_finite(node.value)):
            raise self._refusal("not usable in a condition", ast.unparse(node))

    def _all(self, nodes: list[ast.expr], *, truth: bool) -> bool:
        for node in nodes:
            if self._is_truth(node) != truth:
                wanted = "a condition" if truth else "a number"
                raise self._refusal("not usable here", ast.unparse(node), wanted)
        return True

    def _refusal(self, message: str, value: str, accepted: str = ACCEPTED) -> SpecError:
        return SpecError(message, key=self._key, value=value, accepted=accepted)


class Condition(_Expression):
    """A condition such as ``late < 0.1 and diverged == 0``."""

    def holds(self, values: Mapping[str, Estimate | float]) -> Truth:
        """The truth of the condition for these numbers; None where their intervals do not decide it.

        Raises:
            ArithmeticError: it divides by zero or leaves the range of numbers.
        """
        truth = _value(self._tree, _estimates(values))
        return None if truth is None else bool(truth)

    def _check(self) -> None:
        if not self._is_truth(self._tree):
            raise self._refusal("a number, not a condition", self._text, "a comparison")


class Formula(_Expression):
    """A number such as ``100 * (1 - late / early)``."""

    def estimate(self, values: Mapping[str, Estimate | float]) -> Estimate:
        """The number for these numbers, with its interval.

        Raises:
            ArithmeticError: it divides by zero or leaves the range of numbers.
        """
        found: Estimate = _value(self._tree, _estimates(values))
        return found

    def value(self, values: Mapping[str, Estimate | float]) -> float:
        """The number alone.

        Raises:
            ArithmeticError: it divides by zero or leaves the range of numbers.
        """
        return self.estimate(values).value

    def _check(self) -> None:
        if self._is_truth(self._tree):
            raise self._refusal("a condition, not a number", self._text, "a number")


def _is_finite(constant: object) -> bool:
    return isinstance(constant, int | float) and not isinstance(constant, bool) and isfinite(constant)


def _estimates(values: Mapping[str, Estimate | float]) -> dict[str, Estimate]:
    return {name: one if isinstance(one, Estimate) else exact(float(one)) for name, one in values.items()}


def _not(truth: Truth) -> Truth:
    return None if truth is None else not truth


def _all_true(truths: Iterable[Truth]) -> Truth:
    """Of Kleene's logic: false if one is, else undecided if one is; what comes after a false one is not looked at."""
    decided: Truth = True
    for truth in truths:
        if truth is False:
            return False
        decided = None if truth is None else decided
    return decided


def _value(node: ast.expr, values: Mapping[str, Estimate]) -> Any:
    match node:
        case ast.BoolOp(op=ast.And(), values=parts):
            return _all_true(_value(part, values) for part in parts)
        case ast.BoolOp(values=parts):
            return _not(_all_true(_not(_value(part, values)) for part in parts))
        case ast.Compare(left=left, ops=ops, comparators=others):
            numbers = [_value(part, values) for part in (left, *others)]
            pairs = zip(ops, numbers[:-1], numbers[1:], strict=True)
            return _all_true(COMPARISONS[type(op)](a, b) for op, a, b in pairs)
        case ast.UnaryOp(op=op, operand=operand):
            value = _value(operand, values)
            return _not(value) if isinstance(op, ast.Not) else value.negated() if isinstance(op, ast.USub) else value
        case ast.BinOp(left=left, op=op, right=right):
            return _value(left, values).apply(ARITHMETIC[type(op)], _value(right, values))
        case ast.Call(func=ast.Name(id=name), args=arguments):
            return FUNCTIONS[name](*(_value(argument, values) for argument in arguments))
        case ast.Name(id=name):
            return values[name]
    return exact(float(node.value))  # type: ignore[attr-defined]
