"""The colors of all pictures; without matplotlib, which interactive pages need not wait for."""

from __future__ import annotations

from collections.abc import Iterable

# Okabe and Ito: distinguishable for colour-blind readers, also in print.
PALETTE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#6B5B95", "#7F7F7F")
# Of modes: from a robot that does its task to one that was stopped.
MODES = {"NOMINAL": "#009E73", "STANDBY": "#56B4E9", "HOLD": "#E6B800", "SAFE": "#D55E00", "STOP": "#9B1C13"}
FAULT = "#9B1C13"


def mode_colors(names: Iterable[str]) -> dict[str, str]:
    """Name to color; modes that a table calls otherwise have the next of the palette."""
    found: dict[str, str] = {}
    for name in dict.fromkeys(names):
        others = len(found) - len(found.keys() & MODES.keys())
        found[name] = MODES.get(name, PALETTE[others % len(PALETTE)])
    return found
