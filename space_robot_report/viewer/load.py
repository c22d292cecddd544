"""From a log on disk to what the viewer shows."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from space_robot_bringup.logs.assessed import JudgedLog
from space_robot_bringup.logs.commander import law_said
from space_robot_bringup.logs.foreign_bag import PLAIN, Source
from space_robot_bringup.logs.foreign_log import REFERENCE, read_shown
from space_robot_description.visual import look_of
from space_robot_msgs_py.errors import LogError
from space_robot_msgs_py.escapes import html, visible
from space_robot_msgs_py.paths import StrPath
from space_robot_report.playback import WITHOUT, Footage
from space_robot_report.viewer.show import Show


def load_show(
    log: Path, meshes: Sequence[Path] = (), *, experiment: StrPath | None = None, source: Source = PLAIN
) -> tuple[Show, tuple[str, ...]]:
    """Read a log, whole or corrupted, or a bag of another tool.

    Args:
        log: run directory, bag directory or one of its files.
        meshes: folders the robot's meshes may be read from, see ``look_of``.
        experiment: for bags without one, see ``read_shown``.
        source: of the topics in a bag of another tool.

    Returns:
        What to show, and what is missing, a line each.

    Raises:
        InputFileError: there is no such log.
        LogError: no complete tick can be read, or its robot does not fit its states.
        SpecError: the URDF in it is none.
    """
    judged = read_shown(log, experiment, source)
    look = look_of(judged.header.urdf, meshes)
    if look.model.nq != judged.arrays.q.shape[1]:
        raise LogError("the robot in it has other joints than its states", key=str(log))
    tool = (judged.composition.nominal.tool_frame if judged.composition else "") or look.tool
    missing = tuple(f"drawn without {uri}: {WITHOUT}" for uri in look.missing)
    film = Footage.of(judged.arrays)
    show = Show(
        look,
        film,
        tool,
        _title(judged),
        _about(judged),
        judged.spans,
        judged.happened,
        desired=REFERENCE not in judged.absent,
    )
    return show, (*judged.troubles, *missing)


def _title(judged: JudgedLog) -> str:
    return visible(judged.path.stem.removesuffix("_0"))


def _about(judged: JudgedLog) -> str:
    """A title and a line as HTML; what the log says in them is text, whatever it looks like."""
    experiment = judged.experiment
    law = f"Law <code>{html(law_said(experiment.controller.law, judged.happened))}</code>. " if experiment else ""
    title = f"<p><b>{html(experiment.title)}</b></p>" if experiment and experiment.title else ""
    verdict = f"{html(judged.conclusion[:1].upper() + judged.conclusion[1:])}. " if judged.checks else ""
    remarks = "".join(f"<p>{html(remark.line)}</p>" for remark in judged.remarks)
    return f"{title}<p>{law}{verdict}Ended: {html(judged.end_reason or 'cut')}.</p>{remarks}"
