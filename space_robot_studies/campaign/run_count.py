"""How many runs a point of a campaign has, before its file is checked."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


def runs_of(data: Mapping[str, Any]) -> Any:
    """What a campaign file says in ``runs``, else one per seed in ``seeds``; 0 or None where it says neither."""
    if "runs" in data:
        return data["runs"]
    seeds = data.get("seeds")
    if isinstance(seeds, dict):
        return seeds.get("count")
    return len(seeds) if isinstance(seeds, list | tuple) else 0
