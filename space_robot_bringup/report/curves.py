"""Which curves a panel has and how each looks: by group, by run or by signal, whatever tells them apart."""

from __future__ import annotations

from dataclasses import dataclass

import matplotlib as mpl

from space_robot_bringup.reproduce.measures import FlownRun
from space_robot_bringup.reproduce.reproduction import FlownFigure
from space_robot_bringup.reproduce.spec import Drawing, Panel, Style
from space_robot_msgs_py.interfaces import Vector

# Okabe and Ito: told apart by everybody, also in print.
PALETTE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#6B5B95", "#7F7F7F")
LINES = ("solid", "dashed", "dashdot", "dotted")
# Larger groups are one cloud of thin curves with one entry in the legend.
SINGLY = 8


@dataclass(frozen=True, eq=False, slots=True)
class Curve:
    """One line of a panel."""

    time: Vector
    values: Vector
    color: str
    line: str
    width: float
    alpha: float
    label: str
    held: bool


def curves_of(panel: Panel, flown: FlownFigure) -> list[Curve]:
    """The curves of a panel; a reference or a true value that several runs share is drawn once."""
    runs = shown(panel, flown)
    curves: list[Curve] = []
    seen: set[bytes] = set()
    labelled: set[str] = set()
    for signal in panel.signals:
        for run in runs:
            values = run[1].curves.get(signal)
            if values is None or not values.size:
                continue
            if _is_given(signal):
                if values.tobytes() in seen:
                    continue
                seen.add(values.tobytes())
            curve = _curve(panel, flown, runs, run, signal)
            first = curve.label not in labelled
            labelled.add(curve.label)
            curves.append(curve if first else _unlabelled(curve))
    return curves


def shown(drawing: Drawing, flown: FlownFigure) -> list[FlownRun]:
    """The runs a drawing shows."""
    return [pair for pair in flown.runs if drawing.of is None or pair[0].group in drawing.of]


def color_of(drawing: Drawing, flown: FlownFigure, run: FlownRun) -> str:
    """The color of a run: its own or its group's style, a shade of a sweep, or the next of the palette."""
    planned = run[0]
    for name in (planned.label, planned.group):
        if (style := drawing.style.get(name)) and style.color:
            return style.color
    groups = list(flown.figure.runs)
    members = [pair[0].label for pair in flown.runs if pair[0].group == planned.group]
    sweep = flown.figure.runs[planned.group].sweep
    if sweep and len(members) > 1:
        share = members.index(planned.label) / (len(members) - 1)
        return str(mpl.colors.to_hex(mpl.colormaps["viridis"](0.05 + 0.85 * share)))
    before = sum(_entries(flown, group) for group in groups[: groups.index(planned.group)])
    own = members.index(planned.label) if len(members) <= SINGLY else 0
    return PALETTE[(before + own) % len(PALETTE)]


def text_of(drawing: Drawing, run: FlownRun, members: int) -> str:
    """The legend of a run: what the manifest says, else the label of the run, or of its group where it is large."""
    planned = run[0]
    for name in (planned.label, planned.group):
        if name in drawing.legend:
            return drawing.legend[name]
    return planned.label if members <= SINGLY else f"{planned.group} ({members} runs)"


def _entries(flown: FlownFigure, group: str) -> int:
    """How many colors of the palette a group takes."""
    members = sum(1 for run, _ in flown.runs if run.group == group)
    return 0 if flown.figure.runs[group].sweep and members > 1 else members if members <= SINGLY else 1


def _curve(panel: Panel, flown: FlownFigure, runs: list[FlownRun], run: FlownRun, signal: str) -> Curve:
    members = sum(1 for other, _ in runs if other.group == run[0].group)
    by_signal = len({other.label for other, _ in runs}) == 1
    index = panel.signals.index(signal)
    style = panel.style.get(run[0].label) or panel.style.get(run[0].group) or Style()
    own = panel.style.get(signal) or Style()
    if _is_given(signal):
        color, line, width = "black", "dotted", 1.2
    else:
        color = PALETTE[index % len(PALETTE)] if by_signal else color_of(panel, flown, run)
        line = "solid" if by_signal else LINES[index % len(LINES)]
        width = 1.4 if members <= SINGLY else 0.7
    crowded = members > SINGLY and not _is_given(signal)
    return Curve(
        time=run[1].time,
        values=run[1].curves[signal],
        color=own.color or (color if _is_given(signal) else style.color or color),
        line=own.line or (line if _is_given(signal) else style.line or line),
        width=own.width or style.width or width,
        alpha=0.35 if crowded else 1.0,
        label=_label(panel, runs, run, signal, members),
        held=signal.startswith("command."),
    )


def _label(panel: Panel, runs: list[FlownRun], run: FlownRun, signal: str, members: int) -> str:
    signal_text = panel.legend.get(signal, signal)
    several = len({other.label for other, _ in runs}) > 1
    if _is_given(signal) or not several:
        return signal_text if len(panel.signals) > 1 else text_of(panel, run, members)
    run_text = text_of(panel, run, members)
    if len(panel.signals) == 1 or not run_text:
        return run_text
    return f"{run_text}, {signal_text}" if signal_text else run_text


def _is_given(signal: str) -> bool:
    """What runs are compared with rather than what they did."""
    return signal.endswith(".reference") or signal.startswith("truth/")


def _unlabelled(curve: Curve) -> Curve:
    return Curve(curve.time, curve.values, curve.color, curve.line, curve.width, curve.alpha, "", curve.held)
