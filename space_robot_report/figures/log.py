"""One picture of a log: attitude and joints, desired and measured, the torques, modes as bands and faults as spans."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from space_robot_bringup.experiment.experiment import Experiment
from space_robot_bringup.logs.happened import Witness
from space_robot_bringup.logs.logged import logged_experiment
from space_robot_bringup.logs.spans import Spans
from space_robot_description.rotations import EULER, to_rpy
from space_robot_msgs_py.errors import LogError, SpaceRobotError
from space_robot_msgs_py.escapes import mathtext
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.log.blocks import BlockStacker
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.log.thinning import thinned
from space_robot_report.figures.settings import own_settings
from space_robot_report.palette import FAULT, mode_colors

AXES = ("roll", "pitch", "yaw")
# Height of the panel of modes and faults, over that of the others, and rows in which names of faults take turns.
BAND, ROWS = 0.35, 3
LOOK: dict[str, Any] = {"figsize": (8.0, 10.0), "layout": "constrained"}


def draw(log: Path, out: Path) -> None:
    """Draw a log into an image file.

    Args:
        log: run directory or .mcap file.
        out: the image; its suffix decides the format, PNG without one.

    Raises:
        InputFileError: there is no such log.
        LogError: it holds no complete tick, or the image cannot be written.
    """
    with own_settings():
        figure = Figure(**LOOK)
        _draw(figure, LogReader(log))
    try:
        # With a format given, matplotlib writes to that path and appends no suffix of its own.
        figure.savefig(out, dpi=110, format=out.suffix[1:] or "png")
    except (OSError, ValueError) as error:
        raise LogError(f"the picture cannot be written: {error}", key=str(out)) from None


def figure_of(log: LogReader) -> Figure:
    """Draw a log into a new figure of pyplot, which an interactive session can show.

    Raises:
        LogError: it holds fewer than two complete ticks.
    """
    # Imported only here: pyplot chooses a window toolkit, which writing a file does not need.
    from matplotlib import pyplot as plt

    figure: Figure = plt.figure(**LOOK)
    try:
        _draw(figure, log)
    except SpaceRobotError:
        plt.close(figure)
        raise
    return figure


def _draw(figure: Figure, log: LogReader) -> None:
    witness, joints = Witness(log.rows()), [mathtext(name) for name in log.header.joint_names]
    blocks = BlockStacker(log.header.joint_names, str(log.path)).blocks(witness.rows())
    arrays = thinned(block.arrays for block in blocks if block.arrays is not None)
    if arrays is None or arrays.time.size < 2:
        raise LogError("nothing to draw: fewer than two complete ticks", key=str(log.path))
    spans = Spans.of(witness.events, _experiment(log), float(arrays.time[-1]))
    bands = bool(spans.modes or spans.faults)
    heights = [BAND, 1.0, 1.0, 1.0, 1.0][0 if bands else 1 :]
    panels = figure.subplots(len(heights), 1, sharex=True, height_ratios=heights)
    if bands:
        _spans(panels, spans)
        panels = panels[1:]
    # A plant of another tool may not publish the truth: then it is what was measured.
    truth = arrays.plant.get("true_configuration", arrays.q)
    _followed(panels[0], arrays.time, _attitude(truth), _attitude(arrays.q_d), AXES, f"base attitude, {EULER} [deg]")
    _followed(panels[1], arrays.time, np.degrees(truth[:, 7:]), np.degrees(arrays.q_d[:, 7:]), joints, "joints [deg]")
    _held(panels[2], arrays.time, arrays.wrench[:, 3:], [f"about {axis}" for axis in "xyz"], "base torque [N m]")
    _held(panels[3], arrays.time, arrays.effort_command, joints, "joint effort [N m]")
    panels[3].set_xlabel("time [s]")


def _experiment(log: LogReader) -> Experiment | None:
    try:
        return logged_experiment(log.header.experiment)
    except SpaceRobotError:
        return None


def _spans(panels: Sequence[Any], spans: Spans) -> None:
    """A panel of modes and faults over time; faults are shaded in all others, too."""
    colors = mode_colors(span.name for span in spans.modes)
    for span in spans.modes:
        panels[0].broken_barh([(span.begin, span.end - span.begin)], (0, 1), color=colors[span.name], label="_")
    for name, color in colors.items():
        panels[0].broken_barh([], (0, 1), color=color, label=mathtext(name))
    for index, span in enumerate(spans.faults):
        row = -1.0 - index % ROWS
        panels[0].broken_barh([(span.begin, span.end - span.begin)], (row, 0.9), color=FAULT, alpha=0.25)
        panels[0].annotate(mathtext(span.name), (span.begin, row + 0.4), fontsize="x-small", va="center")
        for panel in panels[1:]:
            panel.axvspan(span.begin, span.end, color=FAULT, alpha=0.12, linewidth=0.0)
    _dress(panels[0], "mode" if not spans.faults else "mode, faults" if spans.modes else "faults")
    panels[0].set_yticks([])
    panels[0].set_ylim(-min(ROWS, len(spans.faults)), 1.0 if spans.modes else 0.1)


def _attitude(q: Vector) -> Vector:
    angles: Vector = np.degrees(np.array([to_rpy(row[3:7]) for row in q]))
    return angles


def _followed(panel: Any, time: Vector, values: Vector, wanted: Vector, names: Sequence[str], label: str) -> None:
    for index, name in enumerate(names):
        (line,) = panel.plot(time, values[:, index], label=name)
        panel.plot(time, wanted[:, index], linestyle=":", color=line.get_color())
    _dress(panel, f"{label}, dotted: desired")


def _held(panel: Any, time: Vector, values: Vector, names: Sequence[str], label: str) -> None:
    for index, name in enumerate(names):
        panel.step(time, values[:, index], where="post", label=name)
    _dress(panel, f"{label}, commanded")


def _dress(panel: Any, label: str) -> None:
    panel.set_title(label, loc="left", fontsize="medium")
    panel.grid(alpha=0.3)
    panel.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False, fontsize="small")
