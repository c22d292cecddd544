"""One decorator for kernels: compiled and cached where numba is, the plain Python function where it is not."""

from __future__ import annotations

import hashlib
import importlib.util
import os
import re
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from space_robot_description.kernel.choice import interpreted
from space_robot_description.kernel.light_numba import without_scipy
from space_robot_description.kernel.turns import Turns
from space_robot_msgs_py.kernel import elementary

try:
    if interpreted():
        raise ImportError("this process compiles nothing")
    import numba
except ImportError:
    numba = None

# Other processes of this installation compile.
INSTALLED = importlib.util.find_spec("numba") is not None
COMPILED = numba is not None
# With NUMBA_DISABLE_JIT=1 numba is there and compiles nothing.
MACHINE_CODE = numba is not None and not numba.config.DISABLE_JIT

if numba is not None:
    without_scipy()
    # It also reads .numba_config.yaml in the working directory, where a file that came with a log may lie: the folder
    # of the cache must not come from there, for a cache is code.
    numba.config.CACHE_DIR = os.environ.get("NUMBA_CACHE_DIR", "")

Function = TypeVar("Function", bound=Callable[..., Any])

_IMPORT = re.compile(r"^\s*(?:from|import)\s+([\w.]+\.kernel)\b", re.MULTILINE)
# Kernel functions own no memory, arrays come from the caller: without reference counts (_nrt) they run a third faster.
_OPTIONS = {"fastmath": False, "error_model": "numpy", "_nrt": False}

if MACHINE_CODE:
    from numba.extending import register_jitable

    for _function in elementary.FUNCTIONS:
        register_jitable(**_OPTIONS)(_function)


def kernel(function: Function) -> Function:
    """Compile a function of scalars, tuples and arrays; no fast-math, so equal inputs give equal bits.

    Without a folder to cache in (a read-only installation without NUMBA_CACHE_DIR) it is compiled once per process.
    """
    if numba is None:
        # As silent on numbers that are not finite as compiled code is.
        return np.errstate(all="ignore")(function)
    try:
        compiled = numba.njit(cache=True, **_OPTIONS)(function)
        _watch_all_sources(compiled)
    except RuntimeError:
        compiled = numba.njit(**_OPTIONS)(function)
    result: Function = compiled
    return result


def inner(function: Function) -> Function:
    """Compile a function that only kernels call: it has no entry from Python and becomes a part of its callers.

    Called, tuples of thirty numbers would pass through memory on their way in and out: the articulated-body algorithm
    takes half as long again.
    """
    return _without_entry(function, forceinline=True)


def called(function: Function) -> Function:
    """Compile a function that only kernels call, once for all its callers in one: for loops over whole matrices."""
    return _without_entry(function)


def _without_entry(function: Function, **options: bool) -> Function:
    if numba is None:
        return function
    result: Function = numba.njit(no_cpython_wrapper=True, no_cfunc_wrapper=True, **options, **_OPTIONS)(function)
    return result


def bound(function: Function, *arguments: object) -> Function:
    """The machine code of a kernel for arguments of these types: the caller vouches that they stay the same.

    It spares numba's look-up of the types on every call, which takes 10 us for tuples of thirty arrays.
    """
    dispatcher: Any = function
    signature = ready(function, *arguments)
    if not signature:
        return function
    result: Function = dispatcher.get_overload(signature)
    return result


_signatures: dict[tuple[object, ...], tuple[Any, ...]] = {}


def ready(function: Callable[..., Any], *arguments: object) -> tuple[Any, ...]:
    """Compile a kernel for arguments of these types now, not at its first call; returns the types it knows them by."""
    dispatcher: Any = function
    if not hasattr(dispatcher, "get_overload"):
        return ()
    # Numba takes 15 us to name the type of one array: a study makes the same parts again and again.
    key = function, *map(type_key, arguments)
    if key not in _signatures:
        signature = tuple(numba.typeof(argument) for argument in arguments)
        dispatcher.compile(signature)
        _signatures[key] = signature
    return _signatures[key]


def type_key(argument: object) -> object:
    """The same of arguments that numba gives the same type."""
    if type(argument) is np.ndarray:
        flags = argument.flags
        return argument.dtype, argument.ndim, flags.c_contiguous, flags.f_contiguous, flags.writeable, flags.aligned
    if isinstance(argument, tuple):
        return type(argument), *map(type_key, argument)
    return type(argument) if isinstance(argument, (bool, int, float, np.generic)) else numba.typeof(argument)


def constants(*numbers: int) -> tuple[Any, ...]:
    """Integers of NumPy: for a literal Python one as argument numba compiles the function again."""
    return tuple(np.int64(number) for number in numbers)


def digest(function: Callable[..., Any]) -> str:
    """The digest of all sources a kernel may contain: its own folder and, transitively, the kernels it imports."""
    return _digest(Path(function.__code__.co_filename))


@cache
def _digest(source: Path) -> str:
    found = hashlib.sha256()
    for path in sorted(_sources(source)):
        found.update(path.name.encode())
        found.update(path.read_bytes())
    return found.hexdigest()


def _sources(source: Path) -> set[Path]:
    """Files whose text can be part of the machine code of a kernel in ``source``.

    A compiled function contains its callees and constants. They stand in its own folder or in a folder named
    ``kernel`` that its own folder imports from (a test forbids kernels to take anything but types from elsewhere).
    """
    folders, found = [Path(__file__).parent, source.parent], set[Path]()
    for folder in folders:
        for path in folder.glob("*.py"):
            found.add(path)
            imported = map(_folder, _IMPORT.findall(path.read_text(encoding="utf-8")))
            folders += [other for other in imported if other is not None and other not in folders]
    return found


@cache
def _folder(package: str) -> Path | None:
    """Where a package lies, without importing it: what is loaded already must not change a digest."""
    top, *rest = package.split(".")
    spec = importlib.util.find_spec(top)
    places = spec.submodule_search_locations if spec else None
    return Path(places[0], *rest) if places else None


def _watch_all_sources(compiled: Any) -> None:
    """Tie the cache entry to every kernel source, and let processes that start together share the compiling.

    Numba compares only the file of the function itself, but a compiled function contains its callees from the other
    files: without this an edited callee would go on being used in its old form.
    """
    cache_file = getattr(getattr(compiled, "_cache", None), "_cache_file", None)
    if cache_file is not None:
        cache_file._source_stamp = digest(compiled.py_func)
        compiled._cache = Turns(compiled._cache)
