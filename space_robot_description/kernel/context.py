"""Values that compiled code finds by their address: one signature for functions that work on values of any types.

The loop of a run is compiled once, and calls the law through a pointer: what laws remember are tuples of other arrays
each, and a number says where they are. Without numba the number is the values themselves.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from space_robot_description.kernel import jit

ROOM = 1 << 14

if jit.MACHINE_CODE:
    from numba import typeof
    from numba.core import cgutils, types
    from numba.extending import intrinsic

    @intrinsic  # type: ignore[untyped-decorator]
    def stored(typing: Any, value: Any, room: Any) -> Any:
        """Write a value into an array of bytes; returns how many it takes."""

        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            kind = context.get_value_type(signature.args[0])
            place = cgutils.create_struct_proxy(signature.args[1])(context, builder, arguments[1]).data
            builder.store(arguments[0], builder.bitcast(place, kind.as_pointer()), align=1)
            return context.get_constant(types.intp, context.get_abi_sizeof(kind))

        return types.intp(value, room), generate

    @intrinsic  # type: ignore[untyped-decorator]
    def loaded(typing: Any, address: Any, kind: Any) -> Any:
        """The values of a type, see ``kind_of``, at an address."""
        found = kind.instance_type

        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            pointer = context.get_value_type(found).as_pointer()
            return builder.load(builder.inttoptr(arguments[0], pointer), align=1)

        return found(address, kind), generate

else:

    def typeof(value: Any) -> Any:
        """No types without a compiler."""
        return None

    def loaded(address: Any, kind: Any) -> Any:
        """The values themselves."""
        return address

    def stored(value: Any, room: Any) -> Any:
        """Not needed without a compiler."""


@dataclass(frozen=True, eq=False, slots=True)
class Context:
    """Values that compiled code knows by an address, kept alive.

    Attributes:
        address: of them; without numba the values themselves.
        values: tuples of arrays and numbers. What is in the arrays may change, the arrays may not.
    """

    address: Any
    values: Any
    room: Any = None


def kind_of(values: Any) -> Any:
    """The type of values, for ``loaded``; None without numba."""
    return typeof(values)


def context_of(values: Any, keep: Callable[[Any, Any], int]) -> Context:
    """Make values known by an address.

    Args:
        values: tuples of arrays and numbers.
        keep: a kernel that calls ``stored``, one for each type of values: the cache of a kernel names all types that
            it was ever called with, and what reads it loads the modules of all of them.
    """
    if not jit.MACHINE_CODE:
        return Context(values, values)
    room = np.zeros(ROOM, dtype=np.uint8)
    if _size(values) > ROOM:
        raise ValueError("too many values for a context")
    keep(values, room)
    return Context(np.int64(room.ctypes.data), values, room)


def _size(values: Any) -> int:
    """Bytes of tuples of arrays of up to two dimensions and numbers, at most."""
    return sum(map(_size, values)) if isinstance(values, tuple) else 80
