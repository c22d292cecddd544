"""Plots as plotly.js takes them, from arrays, with as few points as the picture needs."""

from __future__ import annotations

import base64
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from space_robot_msgs_py.escapes import plotly
from space_robot_msgs_py.interfaces import Vector
from space_robot_report.palette import PALETTE

LIMIT = "#9b1c13"

Dash = Literal["solid", "dot", "dash", "dashdot"]
Steps = Literal["after", "before"]
SHAPES: dict[Steps | None, str] = {"after": "hv", "before": "vh", None: "linear"}


@dataclass(frozen=True, eq=False, slots=True)
class Trace:
    """One line of a plot.

    Attributes:
        name: in the legend; empty: not there.
        time: (K,) [s].
        values: (K,) of any unit; NaN leaves a gap.
        color: of the line.
        dash: of the line.
        steps: a value holds ``after`` its time or held ``before`` it; None: straight lines.
    """

    name: str
    time: Vector
    values: Vector
    color: str
    dash: Dash = "solid"
    steps: Steps | None = None


@dataclass(frozen=True, slots=True)
class Plot:
    """Lines over time under one heading.

    Attributes:
        title: with the unit.
        traces: first drawn first.
        levels: text to value of horizontal lines such as limits.
        log: logarithmic ordinate.
        note: a sentence below the heading.
    """

    title: str
    traces: Sequence[Trace]
    levels: Mapping[str, float] = field(default_factory=dict)
    log: bool = False
    note: str = ""

    def to_plotly(self) -> dict[str, Any]:
        """``data`` and ``layout`` of the figure."""
        y_axis: dict[str, Any] = {"type": "log"} if self.log else {}
        shapes = [_level(level) for level in self.levels.values()]
        # An annotation on a logarithmic axis is placed by the exponent, a shape by the value.
        places = {text: float(np.log10(level)) if self.log else level for text, level in self.levels.items()}
        texts = [_text(text, place) for text, place in places.items()]
        layout = {"yaxis": y_axis, "shapes": shapes, "annotations": texts}
        return {"data": [_trace(trace) for trace in self.traces], "layout": layout}


def lines(
    time: Vector,
    block: Vector,
    names: Sequence[str],
    *,
    dash: Dash = "solid",
    steps: Steps | None = None,
    legend: bool = True,
) -> list[Trace]:
    """One trace per column of a block (K, n), each with the next color."""
    return [
        Trace(name if legend else "", time, block[:, index], PALETTE[index % len(PALETTE)], dash, steps)
        for index, name in enumerate(names)
    ]


def _level(level: float) -> dict[str, Any]:
    line = {"color": LIMIT, "width": 1, "dash": "dash"}
    return {"type": "line", "xref": "paper", "x0": 0, "x1": 1, "y0": level, "y1": level, "line": line}


def _text(text: str, place: float) -> dict[str, Any]:
    corner = {"xref": "paper", "x": 1, "xanchor": "right", "yanchor": "bottom", "showarrow": False}
    return {**corner, "y": place, "text": plotly(text), "font": {"size": 10, "color": LIMIT}}


def _trace(trace: Trace) -> dict[str, Any]:
    kept = min_max(trace.values)
    return {
        "type": "scatter",
        "mode": "lines",
        "name": plotly(trace.name),
        "showlegend": bool(trace.name),
        "x": packed(trace.time[kept], "f4"),
        "y": packed(trace.values[kept], "f4"),
        "line": {"color": trace.color, "width": 1.4, "dash": trace.dash, "shape": SHAPES[trace.steps]},
    }


def packed(values: npt.ArrayLike, kind: Literal["f4", "f8", "u4", "u2"]) -> dict[str, str]:
    """An array as plotly.js and the script of the page read it: bytes in base64, a third of the size of text."""
    data = np.ascontiguousarray(values, dtype=f"<{kind}").tobytes()
    return {"dtype": kind, "bdata": base64.b64encode(data).decode()}


BUCKETS = 500


def min_max(values: Vector, buckets: int = BUCKETS) -> npt.NDArray[np.int64]:
    """Indices of the points to draw: first, last, and of each stretch its smallest and its largest.

    Args:
        values: (K,) signal.
        buckets: number of stretches; up to twice as many points are kept.

    Returns:
        Increasing indices; all of them where there are no more than ``2 * buckets``.
    """
    count = values.size
    if count <= 2 * buckets:
        return np.arange(count)
    width = -(-count // buckets)
    starts = width * np.arange(-(-count // width))
    # The last stretch is filled up with its own last value, which is kept anyway.
    rows = np.pad(values, (0, starts.size * width - count), mode="edge").reshape(-1, width)
    extremes = [starts + rows.argmin(axis=1), starts + rows.argmax(axis=1), [0, count - 1]]
    kept: npt.NDArray[np.int64] = np.unique(np.minimum(np.concatenate(extremes), count - 1))
    return kept
