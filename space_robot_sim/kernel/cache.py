"""Has the plant's kernel been compiled here before?"""

from __future__ import annotations

from pathlib import Path

from space_robot_description.kernel.cache import cached


def must_compile() -> bool:
    """True if the next plant will be compiled first, which takes about 20 s, once."""
    return not cached(Path(__file__).with_name("period.py"), "advance")
