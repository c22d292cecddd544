"""Groups of a manifest expanded to runs: equal runs done once, each with the command for it alone."""

from __future__ import annotations

import hashlib
import json
import re
import shlex
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path
from typing import Any

from space_robot_bringup.experiment.experiment import Experiment, ExperimentFile, read_experiment
from space_robot_description.share import is_file
from space_robot_description.validation import nearest
from space_robot_msgs_py.errors import SpaceRobotError, SpecError
from space_robot_studies.reproduce.campaign_runs import campaign_cases
from space_robot_studies.reproduce.manifest import Claim, Manifest, RunGroup
from space_robot_studies.reproduce.readings import Reading, readings_of

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

    def has(self, wanted: Mapping[str, Any]) -> bool:
        """Whether its keys are set or varied to these values."""
        return all(key in self.values and self.values[key] == value for key, value in wanted.items())

    @property
    def source(self) -> tuple[str, int]:
        """Where its draws come from: its seed, or the number of its run in a campaign."""
        return ("draw", self.values["run"]) if "run" in self.values else ("seed", self.seed)


Runs = dict[str, tuple[PlannedRun, ...]]


@dataclass(frozen=True, slots=True)
class ReadingRuns:
    """A reading of a claim, and the runs of the groups that the claim measures as it wants them."""

    reading: Reading
    groups: Runs

    @property
    def runs(self) -> list[PlannedRun]:
        """All of them."""
        return [run for group in self.groups.values() for run in group]


class Planner:
    """Gives each distinct experiment one name, whatever figures are chosen."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._known: dict[str, DistinctRun] = {}
        self._names: set[str] = set()
        # Readings of many claims share their runs.
        self._changed: dict[str, tuple[PlannedRun, ...]] = {}
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

    def read(self, claim: Claim, manifest: Manifest, figure: str, shown: Runs, key: str) -> Iterator[ReadingRuns]:
        """Every reading of a claim with its runs; a group that it leaves as it is, is that of the figure."""
        groups = manifest.figures[figure].runs
        needed: dict[str, None] = {}
        for number, measure in claim.measures.items():
            for name in measure.all_groups:
                _known(groups, name, f"{key}.measures.{number}.of")
                needed[name] = None
        for reading in readings_of(claim, manifest.choices, key):
            yield ReadingRuns(
                reading,
                {name: self._read(claim, name, groups[name], reading, key) or shown[name] for name in needed},
            )

    def _read(self, claim: Claim, name: str, group: RunGroup, reading: Reading, key: str) -> tuple[PlannedRun, ...]:
        """The runs of a group that a claim measures, as a reading wants them; none if it leaves them as they are."""
        if not (changed := reading.overrides(name)):
            return ()
        values = ", ".join(reading.changing(name).values())
        asked = json.dumps([group.model_dump(exclude_unset=True), name, changed, values], default=str)
        if asked not in self._changed:
            runs = self.expand(name, _altered(name, group, changed, reading, key), key)
            self._changed[asked] = tuple(replace(run, label=f"{run.label} [{values}]") for run in runs)
        return tuple(
            run
            for run in self._changed[asked]
            if any(name in measure.all_groups and run.has(measure.where) for measure in claim.measures.values())
        )

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


def _altered(name: str, group: RunGroup, changed: Mapping[str, Any], reading: Reading, key: str) -> RunGroup:
    """A group with the overrides of a reading; validated again: a key that it varies cannot be set, too."""
    try:
        return RunGroup.model_validate(group.model_dump(exclude_unset=True) | {"set": {**group.set, **changed}})
    except ValueError as error:
        raise SpecError(f"{name} cannot be read so: {error}", key=f"{key}.hangs_on", value=reading.label) from None


def _known(groups: Mapping[str, RunGroup], name: str, key: str) -> None:
    """Refuse a group of runs that a figure does not have.

    Raises:
        SpecError: with the nearest name.
    """
    if name not in groups:
        accepted = nearest(name, groups) or ", ".join(groups)
        raise SpecError("no such group of runs", key=key, value=name, accepted=accepted)


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
