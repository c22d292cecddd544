"""From a manifest to its runs: groups expanded, equal runs done once, each with the command for it alone."""

from __future__ import annotations

import hashlib
import json
import os
import re
import shlex
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

from space_robot_bringup.experiment.experiment import Experiment, ExperimentFile, read_experiment
from space_robot_description.share import is_file, shipped_or_file
from space_robot_description.validation import nearest, parse_yaml, validate
from space_robot_msgs_py.errors import SpaceRobotError, SpecError
from space_robot_msgs_py.paths import StrPath
from space_robot_studies.reproduce.campaign_runs import campaign_cases
from space_robot_studies.reproduce.manifest import Manifest, RunGroup

MAX_NAME = 80


@dataclass(frozen=True, slots=True)
class DistinctRun:
    """A run that is done once, however many figures show it.

    Attributes:
        name: of its bag.
        argument: the experiment as the command line takes it.
        overrides: ``dotted.key=value`` as the command line takes them.
        experiment: what they give.
    """

    name: str
    argument: str
    overrides: tuple[str, ...]
    experiment: Experiment

    @property
    def command(self) -> str:
        """The command for this run alone, to the same bits."""
        settings = [word for override in self.overrides for word in ("--set", override)]
        return shlex.join(["space-robot", "run", self.argument, *settings])


@dataclass(frozen=True, slots=True)
class PlannedRun:
    """A run as one figure shows it.

    Attributes:
        label: group and what varies in it.
        group: of the figure.
        values: what the group sets, by dotted key; ``seed`` too, and ``run`` of a campaign.
        distinct: the run, which other figures may show, too.
    """

    label: str
    group: str
    values: Mapping[str, Any]
    distinct: DistinctRun

    @property
    def seed(self) -> int:
        """Runs of the same seed are partners: in campaigns of one seed they have the same draws."""
        return self.distinct.experiment.seed

    @property
    def source(self) -> tuple[str, int]:
        """Where its draws come from: its seed, or the number of its run in a campaign."""
        return ("draw", self.values["run"]) if "run" in self.values else ("seed", self.seed)


Runs = dict[str, tuple[PlannedRun, ...]]


@dataclass(frozen=True, slots=True)
class Plan:
    """What is to be run for which figure.

    Attributes:
        name: of the paper: file name of its manifest.
        argument: the paper as the command line takes it.
        manifest: it.
        runs: figure -> group -> runs.
    """

    name: str
    argument: str
    manifest: Manifest
    runs: dict[str, Runs]

    def distinct_runs(self, figures: Iterable[str]) -> dict[str, DistinctRun]:
        """The runs these figures take, by name, in the order of the manifest."""
        runs = (run for figure in figures for group in self.runs[figure].values() for run in group)
        return {run.distinct.name: run.distinct for run in runs}


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
    planner = _Planner(path.parent)
    runs = {
        figure_name: {
            label: planner.expand(label, group, f"{name} figures.{figure_name}.runs.{label}")
            for label, group in figure.runs.items()
        }
        for figure_name, figure in manifest.figures.items()
    }
    return Plan(path.stem, name, manifest, runs)


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


class _Planner:
    """Gives each distinct experiment one name, whatever figures are chosen."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._known: dict[str, DistinctRun] = {}
        self._names: set[str] = set()
        # Reading a file takes longer than everything else about a run.
        self._files: dict[str, ExperimentFile] = {}

    def expand(self, label: str, group: RunGroup, key: str) -> tuple[PlannedRun, ...]:
        """The runs of a group, varied values or points first, seeds or draws innermost."""
        if group.campaign or group.disperse:
            return tuple(self._cases(label, group, key))
        beside = self._folder / group.experiment
        argument = str(beside) if is_file(beside) else group.experiment
        axes = {path: _labelled(choices) for path, choices in group.vary.items()}
        if group.seed_list:
            axes["seed"] = [(seed, seed) for seed in group.seed_list]
        runs = []
        for point in product(*axes.values()):
            labels = {path: shown for path, (shown, _) in zip(axes, point, strict=True)}
            values = {**group.set, **{path: value for path, (_, value) in zip(axes, point, strict=True)}}
            words = [Path(argument).stem, *_words({**group.set, **labels})]
            distinct = self._distinct(argument, values, words, key)
            seed = {"seed": distinct.experiment.seed}
            distinguished = {path: value for path, value in labels.items() if len(axes[path]) > 1}
            runs.append(PlannedRun(run_label(label, distinguished), label, {**seed, **group.set, **labels}, distinct))
        return tuple(runs)

    def _cases(self, label: str, group: RunGroup, key: str) -> Iterator[PlannedRun]:
        argument, cases = campaign_cases(group, self._folder, key)
        # Of a campaign this changes its cases; where the group is one, they have it already.
        constant = group.set if group.campaign else {}
        for case in cases:
            words = [Path(group.campaign or argument).stem, *_words({**case.labels, **group.set}), f"{case.run:03d}"]
            distinct = self._distinct(argument, {**case.values, **constant}, words, key)
            varied = {name: value for name, value in case.labels.items() if name not in group.where}
            values = {**case.values, **constant, **case.labels, "run": case.run}
            yield PlannedRun(run_label(label, {**varied, "run": case.run}), label, values, distinct)

    def _distinct(self, argument: str, values: Mapping[str, Any], words: Sequence[str], key: str) -> DistinctRun:
        # JSON is YAML: the value reads back as it stands in the manifest (a date as its text).
        overrides = tuple(f"{path}={json.dumps(value, default=str)}" for path, value in values.items())
        try:
            if argument not in self._files:
                self._files[argument] = read_experiment(argument)
            experiment = self._files[argument].experiment(overrides)
        except SpaceRobotError as error:
            raise SpecError(str(error), key=key) from None
        content = experiment.model_dump_json()
        if content not in self._known:
            name = self._name(words, content)
            self._known[content] = DistinctRun(name, argument, overrides, experiment)
        return self._known[content]

    def _name(self, words: Sequence[str], content: str) -> str:
        name = re.sub(r"[^\w.+-]+", "-", "_".join(words))
        if len(name) > MAX_NAME or name in self._names:
            name = f"{name[:MAX_NAME]}_{hashlib.sha256(content.encode()).hexdigest()[:8]}"
        self._names.add(name)
        return name


def run_label(group: str, varied: Mapping[str, Any]) -> str:
    """What a run, or all runs of a point, are called: the group, and what varies in it."""
    if len(varied) == 1:
        return f"{group} {next(iter(varied.values()))}"
    return f"{group} {', '.join(f'{_last(key)} {value}' for key, value in varied.items())}".strip()


def _labelled(choices: tuple[Any, ...] | dict[str, Any]) -> list[tuple[Any, Any]]:
    """What stands for each value, and the value."""
    return list(choices.items()) if isinstance(choices, dict) else [(value, value) for value in choices]


def _words(values: Mapping[str, Any]) -> list[str]:
    return [f"{_last(path)}-{value}" for path, value in values.items()]


def _last(key: str) -> str:
    return key.rpartition(".")[2]
