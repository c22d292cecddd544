"""Arrays of several robots at once: the last index is the lane, and kernels see arrays of ``vectors.Several``.

``seen(array)`` is what a kernel gets in place of an array; it indexes as an array with one dimension less.
"""

from __future__ import annotations

import operator
from typing import Any

import numpy as np
import numpy.typing as npt

from space_robot_description.kernel import jit

# An aligned row of lanes lies in as few cache lines as it can.
ALIGNMENT = 64


def empty(lanes: int, *shape: int) -> npt.NDArray[np.float64]:
    """Zeros of a shape and lanes, aligned."""
    size = int(np.prod(shape)) * lanes
    room = np.zeros(size + ALIGNMENT // 8)
    first = -room.ctypes.data % ALIGNMENT // 8
    return room[first : first + size].reshape(*shape, lanes)


if jit.MACHINE_CODE:
    from llvmlite import binding, ir
    from numba.core import cgutils, types
    from numba.core.typing.templates import AbstractTemplate, infer_global, signature
    from numba.extending import (
        intrinsic,
        lower_builtin,
        make_attribute_wrapper,
        models,
        overload_attribute,
        register_model,
    )

    from space_robot_description.kernel.vectors import DOUBLE, Several, spread, vector_of

    # As many as one register holds, where there are enough registers; it changes no bit.
    LANES = 8 if binding.get_host_cpu_features().get("avx512f") else 4

    class Lanes(types.Type):  # type: ignore[misc]
        """An array of one or two dimensions of several doubles each."""

        def __init__(self, dimensions: int, lanes: int) -> None:
            self.dimensions, self.several = dimensions, Several(lanes)
            super().__init__(name=f"lanes({dimensions}, {lanes})")

    @register_model(Lanes)
    class _Model(models.StructModel):  # type: ignore[misc]
        """Where it is, and its shape."""

        def __init__(self, manager: Any, kind: Lanes) -> None:
            fields = [("data", types.CPointer(types.float64)), ("rows", types.intp), ("columns", types.intp)]
            super().__init__(manager, kind, fields)

    make_attribute_wrapper(Lanes, "rows", "rows")
    make_attribute_wrapper(Lanes, "columns", "columns")

    @overload_attribute(Lanes, "shape")  # type: ignore[untyped-decorator]
    def _shape(array: Any) -> Any:
        def one(array: Any) -> Any:
            return (array.rows,)

        def two(array: Any) -> Any:
            return array.rows, array.columns

        return one if array.dimensions == 1 else two

    @intrinsic  # type: ignore[untyped-decorator]
    def seen(context: Any, array: Any) -> Any:
        """A C-contiguous float64 array (..., LANES) as lanes."""
        out = Lanes(array.ndim - 1, LANES)

        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            given = cgutils.create_struct_proxy(array)(context, builder, value=arguments[0])
            shape = cgutils.unpack_tuple(builder, given.shape)
            columns = shape[1] if out.dimensions == 2 else context.get_constant(types.intp, 0)
            return _made(context, builder, out, given.data, shape[0], columns)

        return signature(out, array), generate

    @infer_global(operator.getitem)
    class _Get(AbstractTemplate):  # type: ignore[misc]
        """Several doubles, a row, or a part of one."""

        def generic(self, arguments: Any, keywords: Any) -> Any:
            """The signature, if it is about lanes."""
            array, index = arguments
            if not isinstance(array, Lanes):
                return None
            if isinstance(index, types.SliceType) and array.dimensions == 1:
                return signature(array, array, index)
            row = isinstance(index, types.Integer) and array.dimensions == 2
            return signature(Lanes(1, array.several.lanes) if row else array.several, array, index)

    @infer_global(operator.setitem)
    class _Set(AbstractTemplate):  # type: ignore[misc]
        """Several doubles, or one number for all lanes."""

        def generic(self, arguments: Any, keywords: Any) -> Any:
            """The signature, if it is about lanes."""
            array, index, value = arguments
            fits = isinstance(array, Lanes) and isinstance(value, Several | types.Float | types.Integer)
            return signature(types.none, array, index, value) if fits else None

    @lower_builtin(operator.getitem, Lanes, types.Any)  # type: ignore[untyped-decorator]
    def _get(context: Any, builder: Any, found: Any, values: Any) -> Any:
        kind, index = found.args
        zero = context.get_constant(types.intp, 0)
        if isinstance(index, types.SliceType):
            part = context.make_helper(builder, index, values[1])
            data = _pointer(context, builder, kind, values[0], part.start)
            return _made(context, builder, kind, data, builder.sub(part.stop, part.start), zero)
        places = _places(context, builder, index, values[1])
        if kind.dimensions == 2 and len(places) == 1:
            data = _pointer(context, builder, kind, values[0], places[0], zero)
            columns = cgutils.create_struct_proxy(kind)(context, builder, value=values[0]).columns
            return _made(context, builder, found.return_type, data, columns, zero)
        place = _pointer(context, builder, kind, values[0], *places)
        return builder.load(builder.bitcast(place, vector_of(kind.several).as_pointer()), align=8)

    @lower_builtin(operator.setitem, Lanes, types.Any, types.Any)  # type: ignore[untyped-decorator]
    def _set(context: Any, builder: Any, found: Any, values: Any) -> Any:
        kind, index, given = found.args
        place = _pointer(context, builder, kind, values[0], *_places(context, builder, index, values[1]))
        value = spread(context, builder, values[2], given, kind.several)
        builder.store(value, builder.bitcast(place, vector_of(kind.several).as_pointer()), align=8)
        return context.get_dummy_value()

    def _made(context: Any, builder: Any, kind: Lanes, data: Any, rows: Any, columns: Any) -> Any:
        out = cgutils.create_struct_proxy(kind)(context, builder)
        out.data = builder.bitcast(data, DOUBLE.as_pointer())
        out.rows, out.columns = rows, columns
        return out._getvalue()

    def _places(context: Any, builder: Any, kind: Any, index: Any) -> list[Any]:
        """The numbers of an index; none is negative."""
        if isinstance(kind, types.BaseTuple):
            parts = zip(cgutils.unpack_tuple(builder, index), kind.types, strict=True)
            return [context.cast(builder, part, one, types.intp) for part, one in parts]
        return [context.cast(builder, index, kind, types.intp)]

    def _pointer(context: Any, builder: Any, kind: Lanes, array: Any, row: Any, column: Any = None) -> Any:
        """To the first lane of an element."""
        given = cgutils.create_struct_proxy(kind)(context, builder, value=array)
        place = row if column is None else builder.add(builder.mul(row, given.columns), column)
        lanes = ir.Constant(place.type, kind.several.lanes)
        return builder.gep(given.data, [builder.mul(place, lanes)])

else:
    LANES = 1

    def seen(array: Any) -> Any:
        """There are no lanes without a compiler."""
        return array
