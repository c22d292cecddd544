"""A recorded run ready to be computed again: its experiment and its messages by stamp, from any tool."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

from space_robot_bringup.compose.composition import Composition
from space_robot_bringup.compose.controllers import law_sources
from space_robot_bringup.compose.versions import versions
from space_robot_bringup.experiment.controller import ControllerSpec
from space_robot_bringup.experiment.experiment import (
    Overrides,
    experiment_from,
    located,
    read_experiment,
    with_overrides,
)
from space_robot_bringup.logs.foreign_bag import PLAIN, Source, foreign_rows
from space_robot_bringup.logs.logged import compose_logged, confined, law_policy, typed_in
from space_robot_control.laws.policy import LawPolicy
from space_robot_description.validation import parse_yaml_text
from space_robot_msgs_py.errors import InputFileError, LogError, SpecError
from space_robot_msgs_py.interfaces import NANOSECONDS
from space_robot_msgs_py.log.arrays import Row
from space_robot_msgs_py.log.bag import Bag
from space_robot_msgs_py.log.header import LogHeader
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.paths import StrPath
from space_robot_msgs_py.topics import BASE_ODOM


@dataclass(frozen=True, eq=False, slots=True)
class Recording:
    """What was recorded, and what it is computed with now.

    Attributes:
        path: as given.
        composition: of the recorded experiment with what was overridden.
        rows: gives stamp [ns] and canonical messages by topic name of every stamp, in order.
        end_reason: why the run ended; None: the log was truncated, or is another tool's.
        changes: dotted key to (recorded, now) of the configuration.
        versions: package to (recorded, here) where they differ.
        remarks: what a reader should know about the bag.
        foreign: another tool wrote it.
        header: of a run log.
    """

    path: Path
    composition: Composition
    rows: Callable[[], Iterator[Row]]
    end_reason: str | None
    changes: dict[str, tuple[Any, Any]] = field(default_factory=dict)
    versions: dict[str, tuple[str, str]] = field(default_factory=dict)
    remarks: tuple[str, ...] = ()
    foreign: bool = False
    header: LogHeader | None = None


@dataclass(frozen=True, slots=True)
class Code:
    """Which code of a law may be run to compute a log again: what the user typed; see ``law_policy``.

    Attributes:
        laws: ``FILE:Class`` or ``NAME=FILE:Class``.
        allowed: everything the log names.
    """

    laws: tuple[str, ...] = ()
    allowed: bool = False


NO_CODE = Code()


def open_recording(
    path: Path,
    *,
    experiment: StrPath | None = None,
    overrides: Overrides = (),
    source: Source = PLAIN,
    code: Code = NO_CODE,
) -> Recording:
    """Open a log of this project, or a bag of another tool with an experiment that says what it lacks.

    Args:
        path: run directory, bag directory or .mcap file.
        experiment: shipped name or YAML file, for bags without one.
        overrides: see ``load_experiment``.
        source: where the topics are in a bag of another tool.
        code: of laws that may be run.

    Raises:
        SpaceRobotError: no such bag, not readable, no experiment or one that cannot be composed.
    """
    bag = Bag(path)
    if experiment is not None:
        file = read_experiment(experiment)
        # The user typed the name of this file, so it may name code as for a run.
        data, allowed = located(file.content, file.folder), Code(code.laws, allowed=True)
        composition, changes = _composed(data, file.where, overrides, allowed)
        rows, remarks = foreign_rows(bag, composition.joint_names, source)
        _check_period(rows, composition)
        return Recording(path, composition, lambda: iter(rows), None, changes, {}, tuple(remarks), foreign=True)
    try:
        reader = LogReader(path)
    except (LogError, InputFileError) as error:
        accepted = "a log with its header, or --experiment FILE for a bag of another tool"
        raise LogError(error.message, key=error.key, value=error.value, accepted=accepted) from None
    inside = f"{reader.path} experiment.yaml:"
    data = confined(parse_yaml_text(reader.header.experiment, inside), inside)
    composition, changes = _composed(data, str(path), overrides, code)
    if composition.joint_names != reader.header.joint_names and not any(key.startswith("robot") for key in changes):
        raise SpecError("other joints than its experiment", key=str(path), value=reader.header.joint_names)
    _check_period(reader.stamps(), composition)
    recorded, here = reader.header.versions, versions()
    different = {
        name: (recorded.get(name, "absent"), here.get(name, "absent"))
        for name in sorted(recorded | here)
        if recorded.get(name) != here.get(name)
    }
    return Recording(path, composition, reader.stamps, reader.end_reason, changes, different, header=reader.header)


def other_code(recording: Recording) -> list[str]:
    """One line for each custom law whose code here is not that of the log, or of which the log does not say it.

    Raises:
        SpecError: a law cannot be imported.
        CodeError: a law may not be imported.
    """
    if recording.header is None:
        return []
    lines, kept = [], recording.header.laws
    spec = recording.composition.experiment.controller
    for name, here in law_sources(spec, recording.composition.policy).items():
        if name not in kept:
            lines.append(f"the log does not say which code the law {name} had; here sha256 {here.digest[:12]}")
        elif kept[name].digest != here.digest:
            was = kept[name].digest[:12]
            lines.append(f"the law {name} is other code than in the log: sha256 {here.digest[:12]}, was {was}")
    return lines


def _check_period(rows: Iterable[Row], composition: Composition) -> None:
    """With another period than the recorded one there is nothing to compare, whatever the law."""
    stamps = [stamp for stamp, parts in rows if BASE_ODOM.name in parts]
    period = composition.experiment.period
    recorded = min((later - earlier for earlier, later in pairwise(stamps)), default=period)
    if recorded != period:
        accepted = f"{recorded / NANOSECONDS:g} s, which is what was recorded"
        raise SpecError("not that of the bag", key="control_period", value=period / NANOSECONDS, accepted=accepted)


def _composed(
    data: dict[str, Any], where: str, overrides: Overrides, code: Code
) -> tuple[Composition, dict[str, tuple[Any, Any]]]:
    experiment = experiment_from(with_overrides(data, overrides), where)
    policy = _policy(experiment.controller, overrides, code)
    return compose_logged(experiment, policy), changed(data, overrides, where)


def _policy(spec: ControllerSpec, overrides: Overrides, code: Code) -> LawPolicy:
    policy = law_policy(code.laws, spec.laws_by_name, allow_code=code.allowed)
    return replace(policy, typed=typed_in(overrides))


def changed(data: Mapping[str, Any], overrides: Overrides, where: str) -> dict[str, tuple[Any, Any]]:
    """Dotted key to (recorded, now) of every value of the resolved experiment that the overrides change.

    Args:
        data: the recorded experiment.
        overrides: see ``load_experiment``.
        where: its name, for errors.
    """
    if not overrides:
        return {}
    before = flat(experiment_from(data, where).model_dump(mode="json"))
    now = flat(experiment_from(with_overrides(data, overrides), where).model_dump(mode="json"))
    keys = dict.fromkeys((*before, *now))
    return {key: (before.get(key), now.get(key)) for key in keys if before.get(key) != now.get(key)}


def flat(data: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """Values by dotted key; lists are values, but for those of mappings, whose items go by name, or by index."""
    found: dict[str, Any] = {}
    for key, value in data.items():
        inner = _named(value)
        found |= flat(inner, f"{prefix}{key}.") if inner else {f"{prefix}{key}": value}
    return found


def _named(value: Any) -> Mapping[str, Any]:
    """A mapping, or a list of mappings as one; nothing where it is neither."""
    if isinstance(value, Mapping):
        return value
    if not isinstance(value, list) or not all(isinstance(item, Mapping) for item in value):
        return {}
    names = [item.get("name") for item in value]
    named = all(isinstance(name, str) and name for name in names) and len(set(names)) == len(names)
    return {str(names[index] if named else index): item for index, item in enumerate(value)}
