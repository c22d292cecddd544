"""Conditions and formulas over named numbers: arithmetic, comparisons, and/or/not, and nothing else of Python."""

from __future__ import annotations

import ast
import operator
from collections.abc import Callable, Collection, Mapping
from math import isfinite
from typing import Any

from space_robot_description.validation import nearest
from space_robot_msgs_py.errors import SpecError

ARITHMETIC: dict[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
}
COMPARISONS: dict[type[ast.cmpop], Callable[[Any, Any], bool]] = {
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
}
FUNCTIONS: dict[str, Callable[..., Any]] = {"abs": abs, "min": min, "max": max}
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

    def holds(self, values: Mapping[str, float]) -> bool:
        """The truth of the condition for these numbers.

        Raises:
            ArithmeticError: it divides by zero or leaves the range of numbers.
        """
        return bool(_value(self._tree, values))

    def _check(self) -> None:
        if not self._is_truth(self._tree):
            raise self._refusal("a number, not a condition", self._text, "a comparison")


class Formula(_Expression):
    """A number such as ``100 * (1 - late / early)``."""

    def value(self, values: Mapping[str, float]) -> float:
        """The number for these numbers.

        Raises:
            ArithmeticError: it divides by zero or leaves the range of numbers.
        """
        return float(_value(self._tree, values))

    def _check(self) -> None:
        if self._is_truth(self._tree):
            raise self._refusal("a condition, not a number", self._text, "a number")


def _is_finite(constant: object) -> bool:
    return isinstance(constant, int | float) and not isinstance(constant, bool) and isfinite(constant)


def _value(node: ast.expr, values: Mapping[str, float]) -> Any:
    match node:
        case ast.BoolOp(op=op, values=parts):
            return (all if isinstance(op, ast.And) else any)(_value(part, values) for part in parts)
        case ast.Compare(left=left, ops=ops, comparators=others):
            numbers = [_value(part, values) for part in (left, *others)]
            pairs = zip(ops, numbers[:-1], numbers[1:], strict=True)
            return all(COMPARISONS[type(op)](a, b) for op, a, b in pairs)
        case ast.UnaryOp(op=op, operand=operand):
            value = _value(operand, values)
            return not value if isinstance(op, ast.Not) else -value if isinstance(op, ast.USub) else value
        case ast.BinOp(left=left, op=op, right=right):
            result = ARITHMETIC[type(op)](_value(left, values), _value(right, values))
            if not isfinite(result):
                raise OverflowError("beyond the range of numbers")
            return result
        case ast.Call(func=ast.Name(id=name), args=arguments):
            return FUNCTIONS[name](*(_value(argument, values) for argument in arguments))
        case ast.Name(id=name):
            return values[name]
    return node.value  # type: ignore[attr-defined]
