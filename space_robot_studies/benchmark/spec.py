"""The benchmark file: tasks, what is varied, the laws it knows, and the rules that hold for every law."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from hashlib import sha256
from pathlib import Path
from typing import Any

from pydantic import Field, NonNegativeInt, PositiveFloat, PositiveInt

from space_robot_description.share import shipped_or_file
from space_robot_description.spec import Strict, Title
from space_robot_description.validation import nearest, parse_yaml, validate
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.paths import StrPath
from space_robot_studies.campaign.distributions import Draw
from space_robot_studies.campaign.variation import VARY, Vary, point_at
from space_robot_studies.tune.spec import Objective, TunedLaw, Tuning, resolve_tuning


class Rules(Strict):
    """What is the same for every law."""

    budget: PositiveInt = Field(
        default=60, description="evaluations per law, task and point, the given gains among them"
    )
    draws: PositiveInt = Field(default=2, description="runs of an evaluation")
    held_out: PositiveInt = Field(default=20, description="draws that the search never sees, for the judgement")
    seed: NonNegativeInt = Field(default=1, description="of the draws and of the search")


class Task(Strict):
    """A task of the set."""

    title: Title = ""
    experiment: str
    set: dict[str, Any] = Field(default_factory=dict, description="dotted key of the experiment -> value, for all runs")
    disperse: dict[str, Draw] = Field(default_factory=dict, description="dotted key -> how it is dispersed")
    vary: Vary = Field(default_factory=dict, description=f"{VARY}; beside those of the set")
    objective: Objective = Field(default_factory=Objective, description="what is to be small")
    constraints: dict[str, PositiveFloat] = Field(default_factory=dict, description="number of a run -> largest value")


class Short(Strict):
    """A part of the set that is over in minutes, under rules of its own."""

    tasks: tuple[str, ...] = Field(min_length=1, description="of the set")
    laws: tuple[str, ...] = Field(min_length=1, description="of the set")
    vary: Vary = Field(default_factory=dict, description=f"{VARY}; in place of that of set and tasks")
    rules: Rules = Field(default_factory=Rules, description="in place of those of the set")


class Benchmark(Strict):
    """A benchmark file; another version has tasks or rules that are not the same."""

    title: Title = ""
    version: PositiveInt
    rules: Rules = Field(default_factory=Rules, description="the same for every law")
    vary: Vary = Field(default_factory=dict, description=f"{VARY}; every law is tuned at each point by itself")
    laws: dict[str, TunedLaw] = Field(min_length=1, description="name in the tables -> law with the gains it is given")
    tasks: dict[str, Task] = Field(min_length=1, description="name -> task")
    short: Short | None = Field(default=None, description="what --short runs")

    def identity(self) -> dict[str, Any]:
        """What results must have in common to stand in one table: version, digest of tasks, and rules."""
        tasks = {name: task.model_dump(mode="json", exclude={"vary"}) for name, task in self.tasks.items()}
        digest = sha256(json.dumps(tasks, sort_keys=True).encode()).hexdigest()
        return {"version": self.version, "tasks_sha256": digest, "rules": self.rules.model_dump()}

    def tuning(self, task: str, laws: Mapping[str, TunedLaw], path: Path) -> Tuning:
        """The search of laws on a task, resolved.

        Args:
            task: name of it.
            laws: name to law.
            path: of the benchmark file; paths in it are relative to its folder.

        Raises:
            SpecError: the task cannot be used as it is.
        """
        one, rules = self.tasks[task], self.rules
        tuning = Tuning(
            title=one.title or task,
            experiment=one.experiment,
            set=one.set,
            disperse=one.disperse,
            vary=self.vary | one.vary,
            laws=dict(laws),
            objective=one.objective,
            constraints=one.constraints,
            budget=rules.budget,
            draws=rules.draws,
            held_out=rules.held_out,
            seed=rules.seed,
        )
        return resolve_tuning(tuning, path)


def benchmark_path(name_or_path: StrPath) -> Path:
    """The file of a shipped benchmark, or the given path."""
    message = "no such benchmark file or shipped benchmark"
    return shipped_or_file(str(name_or_path), "benchmarks", key="benchmark", message=message)


def load_benchmark(name_or_path: StrPath, *, short: bool = False, only: Sequence[str] = ()) -> Benchmark:
    """Read a benchmark, or a part of it.

    Args:
        name_or_path: a shipped name such as ``v1``, or the path of a YAML file.
        short: the part that the file names.
        only: ``KEY=LABEL`` of what is varied: these points alone. They change no draw and no search of theirs.

    Raises:
        InputFileError: there is no such file.
        SpecError: a key or value cannot be used.
    """
    found = validate(Benchmark, parse_yaml(benchmark_path(name_or_path)), str(name_or_path))
    if short:
        part = found.short
        if part is None:
            raise SpecError("names no short part", key="--short", value=str(name_or_path), accepted="a key short")
        tasks = {
            chosen(name, found.tasks, "short.tasks"): found.tasks[name].model_copy(update={"vary": {}})
            for name in part.tasks
        }
        laws = {chosen(name, found.laws, "short.laws"): found.laws[name] for name in part.laws}
        found = found.model_copy(
            update={"tasks": tasks, "laws": laws, "vary": part.vary, "rules": part.rules, "short": None}
        )
    wanted = _wanted(found, only)
    tasks = {
        name: task.model_copy(update={"vary": _restricted(task.vary, wanted)}) for name, task in found.tasks.items()
    }
    return found.model_copy(update={"vary": _restricted(found.vary, wanted), "tasks": tasks})


def chosen(name: str, known: Mapping[str, Any], key: str) -> str:
    """The name, if there is one.

    Raises:
        SpecError: there is none; the message has the nearest ones.
    """
    if name not in known:
        accepted = nearest(name, tuple(known)) or ", ".join(known)
        raise SpecError("is not in this benchmark", key=key, value=name, accepted=accepted)
    return name


def _wanted(benchmark: Benchmark, only: Sequence[str]) -> dict[str, list[str]]:
    """Key of what is varied to the labels that were typed."""
    sections = (benchmark.vary, *(task.vary for task in benchmark.tasks.values()))
    labels: dict[str, dict[str, None]] = {}
    for section in sections:
        for key, values in section.items():
            labels.setdefault(key, {}).update(dict.fromkeys(_labels(key, values)))
    wanted: dict[str, list[str]] = {}
    for text in only:
        key, _, label = text.partition("=")
        if label not in labels[chosen(key, labels, "--only")]:
            raise SpecError("is no value of it", key=f"--only {key}", value=label, accepted=", ".join(labels[key]))
        wanted.setdefault(key, []).append(label)
    return wanted


def _restricted(vary: Vary, wanted: Mapping[str, Sequence[str]]) -> Vary:
    """What is varied, of the wanted labels alone where there are some."""
    found: Vary = {}
    for key, values in vary.items():
        kept = [at for at, label in enumerate(_labels(key, values)) if key not in wanted or label in wanted[key]]
        if isinstance(values, dict):
            items = list(values.items())
            found[key] = dict(items[at] for at in kept)
        else:
            found[key] = tuple(values[at] for at in kept)
    return found


def _labels(key: str, values: Any) -> list[str]:
    return [str(point_at({key: values}, at).labels[key]) for at in range(len(values))]
