"""From a manifest to its runs, those of the figures and those that readings of the claims need."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from space_robot_description.share import shipped_or_file
from space_robot_description.validation import nearest, parse_yaml, validate
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.paths import StrPath
from space_robot_studies.reproduce.manifest import Manifest
from space_robot_studies.reproduce.planner import DistinctRun, PlannedRun, Planner, ReadingRuns, Runs


@dataclass(frozen=True, slots=True)
class Plan:
    """What is to be run for which figure.

    Attributes:
        name: of the paper: file name of its manifest.
        argument: the paper as the command line takes it.
        manifest: it.
        runs: figure -> group -> runs.
        read: figure -> per claim and reading of it the runs that it needs: those of the figure, or others.
    """

    name: str
    argument: str
    manifest: Manifest
    runs: dict[str, Runs]
    read: dict[str, tuple[tuple[ReadingRuns, ...], ...]]

    def distinct_runs(self, figures: Iterable[str]) -> dict[str, DistinctRun]:
        """The runs these figures take, by name, in the order of the manifest."""
        runs = (run for figure in figures for run in (*self.shown(figure), *self.only_read(figure)))
        return {run.distinct.name: run.distinct for run in runs}

    def shown(self, figure: str) -> list[PlannedRun]:
        """The runs of the groups of a figure."""
        return [run for group in self.runs[figure].values() for run in group]

    def only_read(self, figure: str) -> list[PlannedRun]:
        """The runs that only readings of its claims need, each once."""
        known = {run.distinct.name for run in self.shown(figure)}
        runs = (run for claim in self.read[figure] for reading in claim for run in reading.runs)
        others = {run.distinct.name: run for run in runs if run.distinct.name not in known}
        return list(others.values())


def load_plan(paper: StrPath) -> Plan:
    """Read a manifest and expand its groups.

    Args:
        paper: a shipped name such as ``liu2023``, or the path of a YAML file.

    Raises:
        InputFileError: there is no such paper or experiment.
        SpecError: a key or value cannot be used.
    """
    path, name = manifest_path(paper), os.fspath(paper)
    manifest = read_manifest(path, name)
    _check_pictures(manifest, name)
    planner = Planner(path.parent)
    runs = {
        figure_name: {
            label: planner.expand(label, group, f"{name} figures.{figure_name}.runs.{label}")
            for label, group in figure.runs.items()
        }
        for figure_name, figure in manifest.figures.items()
    }
    read = {
        figure: tuple(
            tuple(planner.read(claim, manifest, figure, runs[figure], f"{name} figures.{figure}.claims.{index}"))
            for index, claim in enumerate(manifest.figures[figure].claims)
        )
        for figure in manifest.figures
    }
    return Plan(path.stem, name, manifest, runs, read)


def read_manifest(path: Path, where: str) -> Manifest:
    """The typed manifest in a file; ``where`` names it in errors."""
    data = parse_yaml(path)
    if isinstance(figures := data.get("figures"), dict):
        # Figure 8 is written 8 in YAML and is a number there.
        data["figures"] = {str(name): figure for name, figure in figures.items()}
    return validate(Manifest, data, where)


def manifest_path(paper: StrPath) -> Path:
    """The manifest of a shipped paper, or the given path."""
    return shipped_or_file(paper, "papers", key="paper", message="no such manifest or shipped paper")


def choose_figures(manifest: Manifest, chosen: Iterable[str]) -> list[str]:
    """The chosen figures in the order of the manifest; all if none is chosen.

    Raises:
        SpecError: there is no such figure.
    """
    wanted = list(chosen)
    for name in wanted:
        if name not in manifest.figures:
            names = list(manifest.figures)
            accepted = nearest(name, names) or ", ".join(names)
            raise SpecError("no such figure", key="--figure", value=name, accepted=accepted)
    return [name for name in manifest.figures if not wanted or name in wanted]


def picture_name(figure: str) -> str:
    """File name of a figure's picture: ``fig08.png`` for figure 8, else its own name."""
    stem = f"fig{int(figure):02d}" if figure.isdecimal() else re.sub(r"[^\w.-]+", "-", figure)
    return f"{stem}.png"


def _check_pictures(manifest: Manifest, where: str) -> None:
    pictures: dict[str, str] = {}
    for name in manifest.figures:
        other = pictures.setdefault(picture_name(name), name)
        if other != name:
            accepted = "names that differ in letters and digits"
            raise SpecError(f"its picture is that of {other!r}", key=f"{where} figures", value=name, accepted=accepted)
