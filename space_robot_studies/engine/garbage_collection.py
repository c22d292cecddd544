"""How often a process that only runs experiments collects garbage."""

from __future__ import annotations

import gc


def collect_rarely() -> None:
    """Look for cycles of garbage a hundred times less often, and not in what is loaded already.

    A run keeps all its ticks, tens of thousands of objects that refer to nothing: searching them again and again
    takes a fifth of its time.
    """
    gc.freeze()
    gc.set_threshold(50_000, 10, 10)
