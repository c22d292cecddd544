"""Plain data that cannot be changed in place, and copies of it that can."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import PurePath
from typing import Any, Never

READ_ONLY = "read-only: what was checked does not change; load it again with other values"


def _refuse(self: object, *args: object, **kwargs: object) -> Never:
    raise TypeError(READ_ONLY)


class FrozenDict(dict[Any, Any]):
    """A mapping that is read, compared, printed and written like a dict, and refuses every change."""

    __setitem__ = __delitem__ = __ior__ = _refuse
    clear = pop = popitem = setdefault = update = _refuse

    def __reduce__(self) -> tuple[type[FrozenDict], tuple[dict[Any, Any]]]:
        """How to copy and to pickle it: the ordinary way would set its items one by one."""
        return FrozenDict, (dict(self),)


class FrozenList(list[Any]):
    """A list that is read, compared, printed and written like a list, and refuses every change."""

    __setitem__ = __delitem__ = __iadd__ = __imul__ = _refuse
    append = clear = extend = insert = pop = remove = reverse = sort = _refuse

    def __reduce__(self) -> tuple[type[FrozenList], tuple[list[Any]]]:
        """How to copy and to pickle it: the ordinary way would append its items one by one."""
        return FrozenList, (list(self),)


def frozen(value: Any) -> Any:
    """The same data with every dict and list in it, at any depth, replaced by one that cannot be changed.

    Raises:
        ValueError: the data contains itself, or is nested more deeply than Python can follow.
    """
    return _copied(_Copy(FrozenDict, FrozenList, tuple, lambda leaf: leaf), value)


def plain(value: Any) -> Any:
    """A copy as YAML or JSON would give it, to be changed at will: dicts, lists, Python's own numbers, paths as text.

    Args:
        value: anything, frozen or not; NumPy's arrays and numbers become Python's, a class its ``module:Class``.

    Raises:
        ValueError: the data contains itself, or is nested more deeply than Python can follow.
    """
    return _copied(_Copy(dict, list, list, _plain_leaf), value)


def _copied(copy: _Copy, value: Any) -> Any:
    try:
        return copy.of(value)
    except RecursionError:
        raise ValueError("is nested too deeply") from None


def _plain_leaf(leaf: Any) -> Any:
    if isinstance(leaf, PurePath):
        return str(leaf)
    if isinstance(leaf, type):
        return f"{leaf.__module__}:{leaf.__qualname__}"
    return leaf.tolist() if hasattr(leaf, "tolist") else leaf


@dataclass(frozen=True, slots=True)
class _Copy:
    """Data made anew from its leaves up. As with ``copy.deepcopy``, what stands in two places is made once."""

    of_mapping: Callable[[dict[Any, Any]], Any]
    of_list: Callable[[list[Any]], Any]
    of_tuple: Callable[[list[Any]], Any]
    of_leaf: Callable[[Any], Any]
    made: dict[int, Any] = field(default_factory=dict)

    def of(self, value: Any) -> Any:
        """The copy of a value, and of what is in it."""
        if type(value) in _LEAVES:
            # Most of all that is copied, and to ask whether it is a mapping takes as long as all else here.
            return value
        # In this order: only whether something is a mapping takes long to ask.
        if not isinstance(value, (dict, list, tuple, Mapping)):
            return self.of_leaf(value)
        if id(value) not in self.made:
            self.made[id(value)] = _IN_WORK
            self.made[id(value)] = self._container(value)
        elif self.made[id(value)] is _IN_WORK:
            raise ValueError("contains itself")
        return self.made[id(value)]

    def _container(self, value: Any) -> Any:
        if isinstance(value, list):
            return self.of_list([self.of(part) for part in value])
        if isinstance(value, tuple):
            return self.of_tuple([self.of(part) for part in value])
        return self.of_mapping({key: self.of(part) for key, part in value.items()})


_IN_WORK = object()
# What a leaf is in YAML and JSON.
_LEAVES = frozenset((bool, int, float, str, type(None)))
