"""Pointers to compiled functions: what is compiled once, calls functions that it does not know."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from space_robot_description.kernel.jit import COMPILED, ready

if COMPILED:
    from numba.core.types import WrapperAddressProtocol
else:
    WrapperAddressProtocol = object  # type: ignore[misc, assignment]


class Pointer(WrapperAddressProtocol):
    """A kernel as a value that another kernel may call; its types are those of example arguments.

    Args:
        function: the kernel, compiled here where it was not before.
        arguments: of the types that it is called with.
    """

    def __init__(self, function: Callable[..., Any], *arguments: object) -> None:
        dispatcher: Any = function
        found = dispatcher.overloads[ready(function, *arguments)]
        self._signature = found.signature
        self._address = found.library.get_pointer_to_function(found.fndesc.llvm_cfunc_wrapper_name)
        # The machine code lives as long as this does.
        self._library = found.library

    def __wrapper_address__(self) -> int:
        return int(self._address)

    def signature(self) -> Any:
        """Of the function."""
        return self._signature
