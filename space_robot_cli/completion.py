"""What a shell offers for an argument: the choices there are, the names that are shipped."""

from __future__ import annotations

from collections.abc import Callable, Sequence

Offer = Callable[[str], list[str]]


def choices(names: Sequence[str]) -> Offer:
    """Offers those of some names that begin as typed."""

    # Typer looks at the name and the type of the argument.
    def offer(incomplete: str) -> list[str]:
        return [name for name in names if name.startswith(incomplete)]

    return offer


def shipped_names(*kinds: str) -> Offer:
    """Offers what is shipped of some kinds, such as ``experiments``."""

    def offer(incomplete: str) -> list[str]:
        from space_robot_description.share import shipped

        return [name for kind in kinds for name in shipped(kind) if name.startswith(incomplete)]

    return offer
