"""One picture of a log: attitude and joints, desired and measured, and the torques."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from space_robot_description.rotations import to_rpy
from space_robot_msgs_py.errors import LogError, SpaceRobotError
from space_robot_msgs_py.escapes import mathtext
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.log.thinning import thinned
from space_robot_report.figures.settings import own_settings

AXES = ("roll", "pitch", "yaw")
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
    arrays, joints = thinned(log.blocks()), [mathtext(name) for name in log.header.joint_names]
    if arrays is None or arrays.time.size < 2:
        raise LogError("nothing to draw: fewer than two complete ticks", key=str(log.path))
    panels = figure.subplots(4, 1, sharex=True)
    # A plant of another tool may not publish the truth: then it is what was measured.
    truth = arrays.plant.get("true_configuration", arrays.q)
    _followed(panels[0], arrays.time, _attitude(truth), _attitude(arrays.q_d), AXES, "base attitude [deg]")
    _followed(panels[1], arrays.time, np.degrees(truth[:, 7:]), np.degrees(arrays.q_d[:, 7:]), joints, "joints [deg]")
    _held(panels[2], arrays.time, arrays.wrench[:, 3:], [f"about {axis}" for axis in "xyz"], "base torque [N m]")
    _held(panels[3], arrays.time, arrays.effort_command, joints, "joint effort [N m]")
    panels[3].set_xlabel("time [s]")


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
