"""Which curves a panel has and how each looks: by group, by run or by signal, whatever tells them apart."""

from __future__ import annotations

from dataclasses import dataclass, replace

import matplotlib as mpl

from space_robot_msgs_py.interfaces import Vector
from space_robot_report.palette import PALETTE
from space_robot_studies.reproduce.manifest import Drawing, Panel
from space_robot_studies.reproduce.measures import FinishedRun
from space_robot_studies.reproduce.reproduction import FigureResult

LINES = ("solid", "dashed", "dashdot", "dotted")
# Larger groups are one cloud of thin curves with one entry in the legend; varied values have shades for more.
SINGLY, SHADES, CROWDED = 4, 8, 0.35


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


def curves_of(panel: Panel, result: FigureResult) -> list[Curve]:
    """The curves of a panel; a reference or a true value that several runs share is drawn once."""
    runs = shown(panel, result)
    curves: list[Curve] = []
    seen: set[bytes] = set()
    labelled: set[str] = set()
    for signal in panel.signals:
        for run in runs:
            # A run that failed at once has no curve.
            if signal not in run[1].curves:
                continue
            curve = _curve(panel, result, runs, run, signal)
            if _is_given(signal):
                if curve.values.tobytes() in seen:
                    continue
                seen.add(curve.values.tobytes())
            first = curve.label not in labelled
            labelled.add(curve.label)
            curves.append(curve if first else replace(curve, label=""))
    return curves


def shown(drawing: Drawing, result: FigureResult) -> list[FinishedRun]:
    """The runs a drawing shows."""
    return [pair for pair in result.runs if drawing.of is None or pair[0].group in drawing.of]


def _text_of(drawing: Drawing, run: FinishedRun, result: FigureResult) -> str:
    """The legend of a run: what the manifest says, else the label of the run, or of its group where it is a cloud."""
    planned = run[0]
    for name in (planned.label, planned.group):
        if name in drawing.legend:
            return drawing.legend[name]
    members = _members(result, planned.group)
    return f"{planned.group} ({len(members)} runs)" if _is_cloud(result, planned.group) else planned.label


def _members(result: FigureResult, group: str) -> list[str]:
    return [run.label for run, _ in result.runs if run.group == group]


def _is_cloud(result: FigureResult, group: str) -> bool:
    return len(_members(result, group)) > (SHADES if result.figure.runs[group].vary else SINGLY)


def _curve(panel: Panel, result: FigureResult, runs: list[FinishedRun], run: FinishedRun, signal: str) -> Curve:
    planned, data = run
    color, line, width = _look(panel, result, runs, run, signal)
    names = (signal,) if _is_given(signal) else (signal, planned.label, planned.group)
    styles = [panel.style[name] for name in names if name in panel.style]
    end = float("inf") if panel.before is None else panel.before
    # Cut, so that what is not seen does not stretch the vertical axis.
    inside = (data.time >= panel.after) & (data.time <= end)
    return Curve(
        time=data.time[inside],
        values=data.curves[signal][inside],
        color=next((style.color for style in styles if style.color), color),
        line=next((style.line for style in styles if style.line), line),
        width=next((style.width for style in styles if style.width), width),
        alpha=CROWDED if _is_cloud(result, planned.group) and not _is_given(signal) else 1.0,
        label=_label(panel, result, runs, run, signal),
        held=signal.startswith("command."),
    )


def _look(
    panel: Panel, result: FigureResult, runs: list[FinishedRun], run: FinishedRun, signal: str
) -> tuple[str, str, float]:
    """Color, line and width where the manifest says none."""
    if _is_given(signal):
        return "black", "dotted", 1.2
    index = [name for name in panel.signals if not _is_given(name)].index(signal)
    if len({other.label for other, _ in runs}) == 1:
        return PALETTE[index % len(PALETTE)], "solid", 1.4
    line = LINES[(index + _nth_varied(result, runs, run[0].group)) % len(LINES)]
    return _color(result, run), line, 0.7 if _is_cloud(result, run[0].group) else 1.4


def _color(result: FigureResult, run: FinishedRun) -> str:
    """A shade of what is varied, or the next of the palette: one for each run of a small group, one for a large one."""
    groups = list(result.figure.runs)
    members = {group: _members(result, group) for group in groups}
    mine = members[run[0].group]
    varied = [group for group in groups if result.figure.runs[group].vary and len(members[group]) > 1]
    if run[0].group in varied:
        share = mine.index(run[0].label) / (len(mine) - 1)
        return str(mpl.colors.to_hex(mpl.colormaps["viridis"](0.05 + 0.85 * share)))
    before = [group for group in groups[: groups.index(run[0].group)] if group not in varied]
    taken = sum(1 if _is_cloud(result, group) else len(members[group]) for group in before)
    own = 0 if _is_cloud(result, run[0].group) else mine.index(run[0].label)
    return PALETTE[(taken + own) % len(PALETTE)]


def _nth_varied(result: FigureResult, runs: list[FinishedRun], group: str) -> int:
    """All varied groups have the same shades: what tells the second of a panel from the first is its line."""
    shown_groups = dict.fromkeys(run.group for run, _ in runs)
    varied = [label for label in shown_groups if result.figure.runs[label].vary]
    return varied.index(group) if group in varied else 0


def _label(panel: Panel, result: FigureResult, runs: list[FinishedRun], run: FinishedRun, signal: str) -> str:
    signal_text = panel.legend.get(signal, signal)
    several = len({other.label for other, _ in runs}) > 1
    if _is_given(signal) or not several:
        return signal_text if len(panel.signals) > 1 else _text_of(panel, run, result)
    run_text = _text_of(panel, run, result)
    if len(panel.signals) == 1 or not run_text:
        return run_text
    return f"{run_text}, {signal_text}" if signal_text else run_text


def _is_given(signal: str) -> bool:
    """What runs are compared with rather than what they did."""
    return signal.endswith(".reference") or signal.startswith("truth/")
