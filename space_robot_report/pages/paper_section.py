"""For a run of a paper: the figures of its manifest this run belongs to, their curves and the paper's claims."""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from space_robot_bringup.experiment.experiment import Experiment, read_experiment
from space_robot_bringup.logs.assessed import JudgedLog
from space_robot_description.share import is_file, shipped
from space_robot_msgs_py.errors import SpaceRobotError
from space_robot_report.pages.plots import Plot, Steps, Trace
from space_robot_report.palette import PALETTE
from space_robot_studies.reproduce.manifest import Claim, Figure, Manifest, Panel
from space_robot_studies.reproduce.plan import manifest_path, read_manifest
from space_robot_studies.reproduce.signals import Signals
from space_robot_studies.reproduce.summary import heading


@dataclass(frozen=True, slots=True)
class PaperFigure:
    """One figure.

    Attributes:
        heading: number and title.
        citation: of the paper.
        caption: of the manifest.
        plots: its panels with the curves of this run.
        claims: of the paper, with the expected verdicts.
        command: that runs the whole figure and judges it.
    """

    heading: str
    citation: str
    caption: str
    plots: tuple[Plot, ...]
    claims: tuple[Claim, ...]
    command: str


def paper_figures(judged: JudgedLog) -> list[PaperFigure]:
    """The figures a run belongs to, those its ``source`` names, else all that run it; none for a run of no paper."""
    experiment, composition = judged.experiment, judged.composition
    if experiment is None or composition is None or not experiment.source:
        return []
    if "true_configuration" not in judged.arrays.plant:
        return []
    found = list(_belonging(experiment))
    chosen = [one for one in found if _names(experiment.source, one[2])]
    chosen = chosen or [one for one in found if one[3].kind == "paper"] or found
    signals = Signals(judged.arrays, composition)
    return [
        PaperFigure(
            heading=heading({"name": name, "kind": figure.kind, "title": figure.title}),
            citation=manifest.citation,
            caption=figure.caption,
            plots=tuple(plot for panel in figure.panels if (plot := _plot(panel, signals)) is not None),
            claims=figure.claims,
            command=shlex.join(["space-robot", "reproduce", paper, "--figure", name]),
        )
        for paper, manifest, name, figure in chosen
    ]


def _names(source: str, figure: str) -> bool:
    """Whether a source such as ``Author 2023, Fig. 1`` names a figure; parts of one, 1a and 1b, are named with it."""
    whole = re.sub(r"(?<=\d)[a-z]$", "", figure)
    return any(re.search(rf"(?<![\w.-]){re.escape(name)}(?![\w-])", source) for name in (figure, whole))


def _belonging(experiment: Experiment) -> Iterator[tuple[str, Manifest, str, Figure]]:
    """Shipped figures that run an experiment of this title and source."""
    identity = (experiment.title, experiment.source)
    for paper in shipped("papers"):
        path = manifest_path(paper)
        manifest = read_manifest(path, paper)
        files = {group.experiment for figure in manifest.figures.values() for group in figure.runs.values()}
        shipped_names = {name for name in files if name and _identity(name, path.parent) == identity}
        for name, figure in manifest.figures.items():
            if shipped_names & {group.experiment for group in figure.runs.values()}:
                yield paper, manifest, name, figure


def _identity(name: str, folder: Path) -> tuple[Any, Any] | None:
    try:
        path = folder / name
        data = read_experiment(path if is_file(path) else name).content
    except SpaceRobotError:
        return None
    return data.get("title", ""), data.get("source", "")


def _plot(panel: Panel, signals: Signals) -> Plot | None:
    """A panel with the curves of one run; None where the run has none of its signals."""
    time, traces = signals.arrays.time, []
    inside = (time >= panel.after) & (time <= (panel.before or float("inf")))
    for index, signal in enumerate(panel.signals):
        try:
            values = signals.of(signal)
        except (KeyError, IndexError, ValueError):
            continue
        given = signal.endswith(".reference") or signal.startswith("truth/")
        color, name = "#000000" if given else PALETTE[index % len(PALETTE)], panel.legend.get(signal, signal)
        steps: Steps | None = "after" if signal.startswith("command.") else None
        traces.append(Trace(name, time[inside], values[inside], color, "dot" if given else "solid", steps))
    title = panel.label or ", ".join(panel.signals)
    return Plot(title, traces, log=panel.y_scale == "log") if traces else None
