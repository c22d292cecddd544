"""A run as a moving picture: the robot as lines, where it should be, and the way of its tool."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
from matplotlib.animation import AbstractMovieWriter, FFMpegWriter, PillowWriter
from matplotlib.figure import Figure

from space_robot_bringup.logs.logged import compose_logged, logged_experiment
from space_robot_description.robot import Robot
from space_robot_msgs_py.errors import LogError, SpecError
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.log.thinning import thinned
from space_robot_report.figures.settings import own_settings
from space_robot_report.playback import Footage

WRITERS: dict[str, Any] = {".gif": PillowWriter, ".mp4": FFMpegWriter}
MAX_FRAMES = 3_000
# Corners of a cube by the bits of their number, in an order in which one line is all of its edges.
ORDER = (0, 4, 6, 2, 0, 1, 5, 4, 5, 7, 6, 7, 3, 2, 3, 1)
CUBE = np.array([[corner >> 2 & 1, corner >> 1 & 1, corner & 1] for corner in ORDER], dtype=float)
DESIRED, ACTUAL, TRACE = "#9aa5b1", "#1f5fa8", "#c0632b"


def film(log: Path, out: Path, *, seconds: float = 8.0, fps: int = 15) -> int:
    """Write a moving picture of a run and return its number of frames.

    Args:
        log: run directory or .mcap file.
        out: FILE.gif, or FILE.mp4 where ffmpeg is installed.
        seconds: how long it lasts, however long the run was.
        fps: frames per second.

    Raises:
        InputFileError: there is no such log.
        SpecError: an option cannot be used, or ffmpeg is not there.
        LogError: fewer than two complete ticks, or the picture cannot be written.
    """
    writer, frames = _writer(out, fps), round(seconds * fps) if 0.0 < seconds < MAX_FRAMES else 0
    if not 2 <= frames <= MAX_FRAMES:
        raise SpecError("gives no film", key="--seconds", value=seconds, accepted=f"2 to {MAX_FRAMES} frames in all")
    reader = LogReader(log)
    arrays = thinned(reader.blocks())
    if arrays is None or arrays.time.size < 2:
        raise LogError("nothing to show: fewer than two complete ticks", key=str(log))
    robot = compose_logged(logged_experiment(reader.header.experiment)).nominal
    footage = Footage.of(arrays)
    with own_settings():
        figure = Figure(figsize=(6.4, 6.4))
        try:
            with writer.saving(figure, str(out), dpi=90):
                stage = _Stage(figure, robot, footage)
                for time in np.linspace(footage.time[0], footage.time[-1], frames):
                    stage.show(int(np.searchsorted(footage.time, time, side="right")) - 1)
                    writer.grab_frame()
        except OSError as error:
            raise LogError(f"cannot be written: {error.strerror or error}", key=str(out)) from None
    return frames


def _writer(out: Path, fps: int) -> AbstractMovieWriter:
    if not 1 <= fps <= 60:
        raise SpecError("not a rate of frames", key="--fps", value=fps, accepted="1 to 60")
    if out.suffix not in WRITERS:
        accepted = "a name that ends in .gif, or in .mp4"
        raise SpecError("not a format of films", key="--out", value=str(out), accepted=accepted)
    if not WRITERS[out.suffix].isAvailable():
        raise SpecError("needs ffmpeg, which is not installed", key="--out", value=str(out), accepted="FILE.gif")
    writer: AbstractMovieWriter = WRITERS[out.suffix](fps=fps)
    return writer


class _Stage:
    """Axes in space that fit the whole run, with lines that are moved from frame to frame."""

    def __init__(self, figure: Figure, robot: Robot, footage: Footage) -> None:
        self._robot, self._footage = robot, footage
        self._data = robot.model.createData()
        axes: Any = figure.add_axes((0.0, 0.04, 1.0, 0.91), projection="3d")
        self._axes = axes
        self._tools = np.array([self._arm(q)[-1] for q in footage.q])
        points = np.vstack([self._arm(q) for q in footage.q[:: max(1, len(footage.q) // 50)]])
        middle, half = (points.max(axis=0) + points.min(axis=0)) / 2.0, float(np.ptp(points, axis=0).max()) / 2.0 + 0.1
        for name, center in zip("xyz", middle, strict=True):
            getattr(axes, f"set_{name}lim")(center - half, center + half)
            getattr(axes, f"set_{name}label")(f"{name} [m]")
        axes.set_box_aspect((1.0, 1.0, 1.0))
        self._drawn = _outward_and_back(robot)
        # The side of the box that stands for the base: as far as the arm is mounted, at most a third of the picture.
        self._side = min(2.0 * float(np.linalg.norm(points[1] - points[0])), half * 2.0 / 3.0)
        self._desired = self._line(DESIRED, 1.5), self._line(DESIRED, 1.0)
        self._actual = self._line(ACTUAL, 3.0), self._line(ACTUAL, 1.5)
        self._trace = self._line(TRACE, 1.0)

    def _line(self, color: str, width: float) -> Any:
        return self._axes.plot([], [], [], color=color, linewidth=width)[0]

    def show(self, tick: int) -> None:
        """Move every line to a tick."""
        footage = self._footage
        for (arm, base), q in ((self._desired, footage.q_d[tick]), (self._actual, footage.q[tick])):
            arm.set_data_3d(*self._arm(q)[self._drawn].T)
            base.set_data_3d(*self._base().T)
        self._trace.set_data_3d(*self._tools[: tick + 1].T)
        self._axes.set_title(f"{self._robot.name}, {footage.time[tick]:.1f} s; grey: desired")

    def _arm(self, q: Vector) -> Vector:
        """(n + 2, 3) base origin, joints in model order, tool [m]; also moves what ``_base`` looks at."""
        pin.forwardKinematics(self._robot.model, self._data, q)
        points = [np.array(placement.translation) for placement in list(self._data.oMi)[1:]]
        tool = self._robot.tool_frame
        if tool and self._robot.model.existFrame(tool):
            number = self._robot.model.getFrameId(tool)
            points.append(np.array(pin.updateFramePlacement(self._robot.model, self._data, number).translation))
        return np.array(points)

    def _base(self) -> Vector:
        """(16, 3) the edges of the box for the base, at the configuration of the last ``_arm``."""
        placement = self._data.oMi[1]
        corners: Vector = (CUBE - 0.5) * self._side @ np.array(placement.rotation).T + np.array(placement.translation)
        return corners


def _outward_and_back(robot: Robot) -> list[int]:
    """Order in which one line is all links between the points of ``_arm``, and nothing else: a tree branches."""
    model, tool = robot.model, robot.tool_frame
    parents = [int(parent) - 1 for parent in list(model.parents)[1:]]
    if tool and model.existFrame(tool):
        parents.append(int(model.frames[model.getFrameId(tool)].parentJoint) - 1)
    order = [0]
    for end in sorted(set(range(len(parents))) - set(parents)):
        inward = [end]
        while inward[-1]:
            inward.append(parents[inward[-1]])
        order += [*reversed(inward), *inward[1:]]
    return order
