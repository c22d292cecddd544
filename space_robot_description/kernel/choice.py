"""Whether this process compiles its kernels."""

from __future__ import annotations

_interpreted = False


def interpret() -> None:
    """Leave the kernels of this process plain Python, bit for bit the same functions, without loading a compiler.

    A process that calls a few of them, each a few times, is done before the compiler is there. It has no effect where
    kernels are loaded already.
    """
    global _interpreted
    _interpreted = True


def interpreted() -> bool:
    """They stay plain Python."""
    return _interpreted
