"""The page of one run: verdict, playback, the paper's claims, every signal, and where it all comes from."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from space_robot_bringup.judge.conclusion import passed
from space_robot_bringup.judge.metrics import ROTATIONS
from space_robot_bringup.logs.assessed import JudgedLog
from space_robot_bringup.logs.commander import law_said
from space_robot_bringup.logs.foreign_bag import PLAIN, Source
from space_robot_bringup.logs.foreign_log import COMMAND, REFERENCE, read_shown
from space_robot_bringup.logs.spans import Spans
from space_robot_description.visual import look_of
from space_robot_msgs_py.atomic_file import write_atomically
from space_robot_msgs_py.errors import SpaceRobotError
from space_robot_msgs_py.interfaces import NANOSECONDS
from space_robot_msgs_py.paths import StrPath
from space_robot_report.pages.html import script
from space_robot_report.pages.interactive import PlotBook, embedded, interactive_page
from space_robot_report.pages.log_plots import SHOWN, conservation_plots, effort_plots, motion_plots, telemetry_plots
from space_robot_report.pages.paper_section import paper_figures
from space_robot_report.pages.scene import scene
from space_robot_report.pages.telemetry import check_units, constants
from space_robot_report.palette import FAULT, mode_colors
from space_robot_report.playback import WITHOUT

TEMPLATE = "log.html.j2"
# Of events in the table; the rest is in the log.
MAX_LISTED = 500


def write_log_report(
    log: Path,
    out: Path,
    meshes: Sequence[Path] = (),
    *,
    experiment: StrPath | None = None,
    source: Source = PLAIN,
) -> JudgedLog:
    """Write the page of a log, whole or corrupted, or of another tool's bag; the page says what is missing.

    Args:
        log: run directory, bag directory or one of its files.
        out: the page.
        meshes: folders the robot's meshes may be read from, see ``look_of``.
        experiment: for bags without one, see ``read_shown``.
        source: of the topics in a bag of another tool.

    Returns:
        What was read.

    Raises:
        InputFileError: there is no such log.
        LogError: no complete tick can be read, or the page cannot be written.
    """
    judged = read_shown(log, experiment, source)
    write_atomically(out, log_page(judged, meshes))
    return judged


def log_page(judged: JudgedLog, meshes: Sequence[Path] = ()) -> str:
    """The page of a log as HTML."""
    book, troubles = PlotBook(), list(judged.troubles)
    played, tool = _played(judged, troubles, meshes)
    spans = judged.spans
    colors = mode_colors(span.name for span in spans.modes)
    content = {
        "title": _title(judged),
        "source": judged.experiment.source if judged.experiment else "",
        "summary": _summary(judged),
        "verdict": _verdict(judged),
        "rotations": ROTATIONS,
        "units": check_units(judged.metrics),
        "metrics": judged.metrics,
        "scene": embedded(played) if played else "",
        "tool": tool,
        "figures": _figures(judged, book, troubles),
        "sections": _sections(judged, book),
        "provenance": _provenance(judged),
        "events": judged.happened[:MAX_LISTED],
        "left_out": max(0, len(judged.happened) - MAX_LISTED),
        "spans": spans,
        "colors": colors,
        "marks": embedded([event.stamp / NANOSECONDS for event in judged.events]),
        "bands": embedded(_bands(spans, colors)),
        "experiment": judged.header.experiment,
        "troubles": troubles,
        "playback_script": script("playback.js"),
    }
    return interactive_page(TEMPLATE, book, content)


def _title(judged: JudgedLog) -> str:
    title = judged.experiment.title if judged.experiment else ""
    return title or judged.path.stem


def _summary(judged: JudgedLog) -> str:
    arrays, experiment = judged.arrays, judged.experiment
    what = f"{judged.ticks} ticks, {arrays.time[-1] - arrays.time[0]:g} s"
    if experiment is not None:
        robot = experiment.robot["name"] if isinstance(experiment.robot, dict) else experiment.robot
        law = law_said(experiment.controller.law, judged.happened)
        what = f"{robot} under {law}: {what}, control period {experiment.control_period:g} s"
    return f"{what}. Ended: {judged.end_reason or 'cut'}."


def _verdict(judged: JudgedLog) -> dict[str, Any]:
    checks = judged.checks
    return {"conclusion": judged.conclusion, "passed": passed(checks), "checks": checks, "remarks": judged.remarks}


def _played(judged: JudgedLog, troubles: list[str], meshes: Sequence[Path]) -> tuple[dict[str, Any] | None, str]:
    """What the playback shows, and the link whose way it draws."""
    try:
        look = look_of(judged.header.urdf, meshes)
    except SpaceRobotError as error:
        troubles.append(f"no playback: {error}")
        return None, ""
    if look.model.nq != judged.arrays.q.shape[1]:
        troubles.append("no playback: the robot in the log has other joints than its states")
        return None, ""
    if look.missing:
        troubles.append(f"drawn without {', '.join(look.missing)}: {WITHOUT}")
    composition = judged.composition
    tool = (composition.nominal.tool_frame if composition else "") or look.tool
    return scene(look, judged.arrays, tool), tool


def _figures(judged: JudgedLog, book: PlotBook, troubles: list[str]) -> list[dict[str, Any]]:
    try:
        found = paper_figures(judged)
    except SpaceRobotError as error:
        troubles.append(f"no figure of a paper: {error}")
        return []
    return [
        {
            "heading": figure.heading,
            "citation": figure.citation,
            "caption": figure.caption,
            "plots": book.all(figure.plots),
            "claims": figure.claims,
            "command": figure.command,
        }
        for figure in found
    ]


def _bands(spans: Spans, colors: Mapping[str, str]) -> list[dict[str, Any]]:
    """What is shaded in every plot: faults over its whole height, modes as a strip above it."""
    modes = [{"begin": span.begin, "end": span.end, "color": colors[span.name], "fault": False} for span in spans.modes]
    return modes + [{"begin": one.begin, "end": one.end, "color": FAULT, "fault": True} for one in spans.faults]


def _sections(judged: JudgedLog, book: PlotBook) -> list[dict[str, Any]]:
    arrays, joints = judged.arrays, judged.header.joint_names
    robot = judged.composition.nominal if judged.composition else None
    sections = {
        "Motion": motion_plots(
            arrays, joints, robot, whole=judged.ticks == arrays.stamp.size, desired=REFERENCE not in judged.absent
        ),
        "Torques and wheels": () if COMMAND in judged.absent else effort_plots(arrays, joints, robot),
        "What the law shows": telemetry_plots(arrays.time, arrays.controller, joints),
        "Conservation": conservation_plots(arrays),
        "What else the plant shows": telemetry_plots(arrays.time, arrays.plant, joints),
    }
    folded = {
        "What the law shows": constants(arrays.controller),
        "What else the plant shows": constants({k: v for k, v in arrays.plant.items() if k not in SHOWN}),
    }
    drawn = [
        {
            "title": title,
            "anchor": title.lower().replace(" ", "-"),
            "plots": book.all(list(plots)),
            "constants": folded.get(title, []),
        }
        for title, plots in sections.items()
    ]
    return [section for section in drawn if section["plots"] or section["constants"]]


def _provenance(judged: JudgedLog) -> dict[str, str]:
    header = judged.header
    said = {
        "log": judged.path.name,
        "mode": judged.mode or "not known: it is in metadata.yaml, beside the log",
        "seed": str(header.seed) if header.experiment else "",
        "joints": ", ".join(header.joint_names),
        "end": judged.end_reason or "cut",
    }
    return {name: text for name, text in said.items() if text} | {
        f"version of {name}": version for name, version in header.versions.items()
    }
