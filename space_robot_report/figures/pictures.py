"""pyplot for files only: no window is ever opened."""

from __future__ import annotations

import matplotlib as mpl

mpl.use("Agg")

from matplotlib import pyplot as plt

from space_robot_report.figures.settings import own_settings

__all__ = ["own_settings", "plt"]
