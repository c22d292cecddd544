"""A few doubles side by side as one number of compiled code: kernels compile for it as they are, lane by lane equal.

Sums, products, quotients and square roots are those of IEEE 754 in every lane, and what ``elementary`` makes of them.
Nothing is fused or reordered, so that a lane has the bits of the scalar kernel. It uses numba's interface for
extensions, and is loaded where lanes are used.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.typeconv import Conversion
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import intrinsic, lower_builtin, lower_cast, models, overload, register_model

from space_robot_msgs_py.kernel.elementary import power_of_two

DOUBLE = ir.DoubleType()
ARITHMETIC = {"add": "fadd", "sub": "fsub", "mul": "fmul", "truediv": "fdiv"}
IN_HARDWARE = {math.sqrt: "sqrt", abs: "fabs"}


class Several(types.Type):  # type: ignore[misc]
    """The type of ``lanes`` doubles; a number that all of them share converts to it."""

    def __init__(self, lanes: int) -> None:
        self.lanes = lanes
        super().__init__(name=f"several({lanes})")

    def can_convert_from(self, context: Any, other: Any) -> Any:
        """Numbers do."""
        return Conversion.promote if _is_number(other) else None

    def unify(self, context: Any, other: Any) -> Any:
        """A variable that is a number first and several later is several."""
        return self if _is_number(other) else None


@register_model(Several)
class _Model(models.PrimitiveModel):  # type: ignore[misc]
    """A vector register, or a few."""

    def __init__(self, manager: Any, kind: Several) -> None:
        super().__init__(manager, kind, vector_of(kind))


def vector_of(kind: Several) -> Any:
    """Its type in LLVM."""
    return ir.VectorType(DOUBLE, kind.lanes)


def spread(context: Any, builder: Any, value: Any, kind: Any, to: Several) -> Any:
    """A value as several: a number in all lanes."""
    if kind == to:
        return value
    number, vector, index = context.cast(builder, value, kind, types.float64), vector_of(to), ir.IntType(32)
    first = builder.insert_element(ir.Constant(vector, ir.Undefined), number, ir.Constant(index, 0))
    places = ir.Constant(ir.VectorType(index, to.lanes), [0] * to.lanes)
    return builder.shuffle_vector(first, ir.Constant(vector, ir.Undefined), places)


def _is_number(kind: Any) -> bool:
    return isinstance(kind, types.Float | types.Integer)


def _several(kinds: Any) -> Several | None:
    """Of an operation's arguments, if one of them is several and the others go with it."""
    found = next((kind for kind in kinds if isinstance(kind, Several)), None)
    return found if found and all(kind == found or _is_number(kind) for kind in kinds) else None


def _typed(function: Any, count: int) -> None:
    """Let a function of that many arguments have several as its result where one of them is."""

    class Template(AbstractTemplate):  # type: ignore[misc]
        """Found by numba."""

        def generic(self, arguments: Any, keywords: Any) -> Any:
            """The signature, if it is about lanes."""
            kind = _several(arguments) if len(arguments) == count else None
            return signature(kind, *arguments) if kind else None

    infer_global(function)(Template)


def _binary(function: Any, code: Callable[[Any, Any, Any], Any]) -> None:
    def lowered(context: Any, builder: Any, found: Any, values: Any) -> Any:
        kind = found.return_type
        a, b = (spread(context, builder, *one, kind) for one in zip(values, found.args, strict=True))
        return code(builder, a, b)

    _typed(function, 2)
    for first, second in ((Several, Several), *((Several, one) for one in _NUMBERS), *((o, Several) for o in _NUMBERS)):
        lower_builtin(function, first, second)(lowered)


def _unary(function: Any, code: Callable[[Any, Any, Any, Several], Any]) -> None:
    def lowered(context: Any, builder: Any, found: Any, values: Any) -> Any:
        return code(context, builder, values[0], found.return_type)

    _typed(function, 1)
    lower_builtin(function, Several)(lowered)


def _instruction(name: str) -> Callable[[Any, Any, Any, Several], Any]:
    def code(context: Any, builder: Any, value: Any, kind: Several) -> Any:
        vector = vector_of(kind)
        called = f"llvm.{name}.v{kind.lanes}f64"
        function = cgutils.get_or_insert_function(builder.module, ir.FunctionType(vector, [vector]), called)
        return builder.call(function, [value])

    return code


@intrinsic  # type: ignore[untyped-decorator]
def _exponent(context: Any, n: Any) -> Any:
    """Integers from -1022 to 1023 where a double has its exponent."""

    def generate(context: Any, builder: Any, found: Any, values: Any) -> Any:
        integers = ir.VectorType(ir.IntType(64), n.lanes)
        bias, place = (ir.Constant(integers, [number] * n.lanes) for number in (1023, 52))
        exponent = builder.add(builder.fptosi(values[0], integers), bias)
        return builder.bitcast(builder.shl(exponent, place), vector_of(n))

    return signature(n, n), generate


def _chosen(comparison: str) -> Callable[[Any, Any, Any], Any]:
    """As numba has ``max`` and ``min``: the second where it compares so to the first, else the first."""
    return lambda builder, a, b: builder.select(builder.fcmp_ordered(comparison, b, a), b, a)


def _arithmetic(instruction: str) -> Callable[[Any, Any, Any], Any]:
    return lambda builder, a, b: getattr(builder, instruction)(a, b)


def _negated(context: Any, builder: Any, value: Any, kind: Several) -> Any:
    return builder.fneg(value)


_NUMBERS = (types.Float, types.Integer)
for _number in _NUMBERS:
    lower_cast(_number, Several)(lambda context, builder, kind, to, value: spread(context, builder, value, kind, to))
for _name, _code in ARITHMETIC.items():
    for _operator in (getattr(operator, _name), getattr(operator, f"i{_name}")):
        _binary(_operator, _arithmetic(_code))
_binary(max, _chosen(">"))
_binary(min, _chosen("<"))
_unary(operator.neg, _negated)
for _function, _code in IN_HARDWARE.items():
    _unary(_function, _instruction(_code))


@overload(power_of_two)  # type: ignore[untyped-decorator]
def _power_of_two(n: Any) -> Any:
    def of_several(n: Any) -> Any:
        return _exponent(n)

    return of_several if isinstance(n, Several) else None
