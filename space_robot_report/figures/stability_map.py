"""The stability map of the model-free law as a picture."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from space_robot_control.laws.mfac.stability import stability_map
from space_robot_report.figures.chart import plain
from space_robot_report.palette import PALETTE
from space_robot_studies.reproduce.stability_map import StabilityMap

HELD, DELAYED = "#cfe3f1", "#7fb2d6"
MARKERS = "osD^v*"


def draw_stability(axis: Any, wanted: StabilityMap) -> None:
    """Draw the stable regions, their borders at spectral radius 1, and the marks."""
    ratios, rhos = (np.geomspace(*ends, wanted.points) for ends in (wanted.ratio, wanted.rho))
    prompt, late = (stability_map(ratios, rhos, delay, "held", wanted.lead) for delay in (0, 1))
    for radius, color in ((prompt, HELD), (np.maximum(prompt, late), DELAYED)):
        axis.contourf(ratios, rhos, radius.T, levels=[0.0, 1.0], colors=[color])
    printed = stability_map(ratios, rhos, 0, "euler", wanted.lead)
    if printed.min() < 1.0 < printed.max():
        axis.contour(ratios, rhos, printed.T, levels=[1.0], colors="black", linestyles="dashed", linewidths=1.2)
    handles: list[Any] = [
        Patch(color=HELD, label="stable, held command"),
        Patch(color=DELAYED, label="also with a period of delay"),
        Line2D([], [], color="black", linestyle="dashed", label="border of the difference equation"),
    ]
    for index, (text, mark) in enumerate(wanted.marks.items()):
        look = {"marker": MARKERS[index % len(MARKERS)], "color": PALETTE[(1 + index) % len(PALETTE)]}
        handles += axis.plot([mark.ratio], [mark.rho], linestyle="none", label=plain(text), zorder=3.0, **look)
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.set_xlim(*wanted.ratio)
    axis.set_ylim(*wanted.rho)
    axis.set_xlabel("phi^2 / lambda [-]")
    axis.set_ylabel("rho_3 [-]")
    axis.set_title(plain(wanted.label), loc="left", fontsize="medium")
    axis.legend(handles=handles, loc="center left", bbox_to_anchor=(1.0, 0.5))
