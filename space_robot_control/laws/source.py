"""The source of a custom law: the log carries it, so that a replay can tell whether it runs the same one."""

from __future__ import annotations

import linecache
import sys
from hashlib import sha256
from pathlib import Path
from types import FunctionType

from space_robot_control.laws.base import Law
from space_robot_control.laws.registry import BUILT_IN
from space_robot_msgs_py.bounded_files import read_bytes
from space_robot_msgs_py.errors import SpaceRobotError
from space_robot_msgs_py.limits import LAW_SOURCE_BYTES
from space_robot_msgs_py.log.header import LawSource

_SHIPPED = frozenset(path.partition(":")[0] for path in BUILT_IN.values())


def source_of(cls: type[Law]) -> LawSource | None:
    """The file a law is defined in, or its notebook cell.

    None for a shipped law, which its version tells, and where there is neither.

    What that file imports is not in it.
    """
    if cls.__module__ in _SHIPPED:
        return None
    file = getattr(sys.modules.get(cls.__module__), "__file__", None)
    if file is None:
        return _typed(cls)
    try:
        content = read_bytes(Path(file), LAW_SOURCE_BYTES)
    except SpaceRobotError:
        # Gone since, or larger than any source.
        return None
    try:
        text = content.decode("utf-8")
    except UnicodeDecodeError:
        # A compiled module has a digest, and nothing to read.
        text = ""
    return LawSource(cls.__qualname__, sha256(content).hexdigest(), text)


def _typed(cls: type[Law]) -> LawSource | None:
    """What was typed where there is no file: notebooks keep the text of their cells for tracebacks.

    The cell is that of a function of the class itself; None where it has none, or none that is kept.
    """
    functions = (value for value in vars(cls).values() if isinstance(value, FunctionType))
    text = next(filter(None, ("".join(linecache.getlines(one.__code__.co_filename)) for one in functions)), "")
    return LawSource(cls.__qualname__, sha256(text.encode()).hexdigest(), text) if text else None
