"""Lazy faces: a package names what others should use, and imports it when it is asked for.

A face is three lists that a test holds equal: ``__all__``, the imports that type checkers and editors read, and the
table of modules that Python reads::

    __all__ = ["Law"]

    if TYPE_CHECKING:
        from space_robot_control.laws.base import Law
    else:
        _MODULES = {"space_robot_control.laws.base": ("Law",)}
        __getattr__, __dir__ = lazy_face(__name__, _MODULES)

Type checkers must not see ``__getattr__``: to them a package with one has every name there could be.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from typing import Any


def lazy_face(
    package: str, modules: Mapping[str, Sequence[str]]
) -> tuple[Callable[[str], Any], Callable[[], list[str]]]:
    """Make ``__getattr__`` and ``__dir__`` of a package whose names are imported when they are first used.

    Args:
        package: its ``__name__``.
        modules: module to the public names that are defined in it.
    """
    where = {name: module for module, names in modules.items() for name in names}

    def load(name: str) -> Any:
        """Import a name; Python calls this for what the package does not have yet."""
        if name not in where:
            raise AttributeError(
                f"module {package!r} has no attribute {name!r}", name=name, obj=sys.modules.get(package)
            )
        value = getattr(import_module(where[name]), name)
        # The next use finds it without coming here.
        setattr(sys.modules[package], name, value)
        return value

    def listed() -> list[str]:
        """The public names, for ``dir`` and completion."""
        return sorted(where)

    return load, listed
