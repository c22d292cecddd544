"""Whose versions can change the bits of a run."""

from __future__ import annotations

import platform

# Everything whose version can change the bits of a run; the log carries it.
VERSIONED = ("space-robot", "numpy", "pin", "numba", "mcap", "rosbags")


def versions() -> dict[str, str]:
    """Versions of everything that can change the bits of a run."""
    # Here, because it loads a reader of e-mail, and only a log has versions.
    from importlib import metadata

    found: dict[str, str] = {"python": platform.python_version()}
    for name in VERSIONED:
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            found[name] = "absent"
    return found
