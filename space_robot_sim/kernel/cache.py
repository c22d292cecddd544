"""Has the kernel been compiled here before? Asked without loading the compiler."""

from __future__ import annotations

import os
from importlib.util import find_spec
from pathlib import Path


def must_compile() -> bool:
    """True if the next plant will be compiled first, which takes about 20 s, once.

    A cache elsewhere (NUMBA_CACHE_DIR) is taken as filled: nobody can tell from here.
    """
    if find_spec("numba") is None or "NUMBA_CACHE_DIR" in os.environ:
        return False
    return not any((Path(__file__).parent / "__pycache__").glob("period.fly-*.nbi"))
