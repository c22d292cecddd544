"""A loop over nothing asserts nothing."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeVar

T = TypeVar("T")


def nonempty(items: Iterable[T]) -> list[T]:
    """The items, of which there is at least one."""
    found = list(items)
    assert found, "there is nothing to look at"
    return found
