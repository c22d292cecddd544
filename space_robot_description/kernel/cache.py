"""Has a kernel been compiled here before? Asked without loading the compiler."""

from __future__ import annotations

import os
from importlib.util import find_spec
from pathlib import Path


def cached(source: Path, function: str) -> bool:
    """True if a function of a source file need not be compiled: done before, or there is no compiler.

    A cache elsewhere (NUMBA_CACHE_DIR) is taken as filled: it cannot be inspected from here.
    """
    if find_spec("numba") is None or "NUMBA_CACHE_DIR" in os.environ:
        return True
    return any((source.parent / "__pycache__").glob(f"{source.stem}.{function}-*.nbi"))
