"""The experiment file: one YAML, typed, resolved once, the single source of a run."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import (
    Field,
    NonNegativeInt,
    PositiveFloat,
    SerializerFunctionWrapHandler,
    model_serializer,
    model_validator,
)

from space_robot_bringup.experiment.base import BASE, with_base
from space_robot_bringup.experiment.controller import ControllerSpec, check_controller
from space_robot_bringup.experiment.expectations import AnyExpectation
from space_robot_bringup.experiment.overrides import Assignment as Assignment
from space_robot_bringup.experiment.overrides import Overrides as Overrides
from space_robot_bringup.experiment.overrides import assignments as assignments
from space_robot_bringup.experiment.overrides import parsed as parsed
from space_robot_bringup.experiment.overrides import with_overrides as with_overrides
from space_robot_bringup.experiment.plant import AnyPlant, ModelSpec, PlantSpec
from space_robot_bringup.experiment.readable import dump_yaml
from space_robot_bringup.experiment.recorded_reference import with_recorded_log
from space_robot_bringup.experiment.timebase import steps_of, to_nanoseconds
from space_robot_control.references.spec import ReferenceSpec
from space_robot_description.later import Later
from space_robot_description.share import config_dir, is_file, shipped_or_file
from space_robot_description.spec import PerJoint, Strict, Three, Title
from space_robot_description.validation import parse_yaml, validate
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.paths import StrPath

if TYPE_CHECKING:
    from space_robot_sim.faults.catalogue import AnyFault
    from space_robot_supervisor.table import SupervisionTable
else:
    AnyFault = Annotated[Any, Later("space_robot_sim.faults.catalogue:AnyFault")]
    SupervisionTable = Annotated[Any, Later("space_robot_supervisor.table:SupervisionTable")]

# Dotted key to value, or texts ``dotted.key=value`` with the value in YAML.


class Initial(Strict):
    """Where and how the robot starts; what is not said is zero, joints start at the robot's home."""

    position: Three = Field(default=(0.0, 0.0, 0.0), description="base origin in the inertial frame [m]")
    attitude_deg: Three = Field(default=(0.0, 0.0, 0.0), description="roll, pitch, yaw (R = Rz Ry Rx) [deg]")
    joints_deg: PerJoint | None = Field(
        default=None, description="one number, a list, or a mapping by joint name [deg]"
    )
    joints: PerJoint | None = Field(default=None, description="the same in [rad] or [m]")
    linear_velocity: Three = Field(default=(0.0, 0.0, 0.0), description="of the base, body frame [m/s]")
    angular_velocity: Three = Field(default=(0.0, 0.0, 0.0), description="of the base, body frame [rad/s]")

    @model_validator(mode="after")
    def _said_once(self) -> Self:
        if self.joints is not None and self.joints_deg is not None:
            raise ValueError("give joints or joints_deg, not both")
        return self


class NominalSpec(ModelSpec):
    """What the flight software believes."""

    payload_known: Annotated[float, Field(ge=0.0, le=1.0)] | None = Field(
        default=None, description="instead of payload: this fraction of the real payload's mass and inertia [-]"
    )
    delay_periods: Literal[0, 1] = Field(
        default=0, description="a command acts in the period of its state, or the next, as far as the laws know"
    )

    friction: bool = Field(
        default=False, description="laws add the friction of actuators.joints at the desired rates to their efforts"
    )
    wheels: bool = Field(
        default=True, description="laws know the momentum of the reaction wheels; false: they take it for 0"
    )

    @model_serializer(mode="wrap")
    def _without_what_is_not(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        # The log of a run whose laws assume what is usual is, to the byte, what it was before they could do otherwise.
        usual = {"delay_periods": 0, "friction": False, "wheels": True}
        return {key: value for key, value in handler(self).items() if key not in usual or value != usual[key]}

    @model_validator(mode="after")
    def _one_payload(self) -> Self:
        if self.payload is not None and self.payload_known is not None:
            raise ValueError("give payload or payload_known, not both")
        return self


class Experiment(Strict):
    """One run of one robot under one law: everything that decides its bits.

    ``robot`` is the name of a shipped robot, the path of a robot file (relative to this file), or, in a resolved
    experiment, the robot file's content.
    """

    title: Title = Field(default="", description="what this is, in one line")
    source: Title = Field(default="", description="paper and figure this reproduces")
    robot: str | dict[str, Any]
    control_period: PositiveFloat = Field(description="[s]")
    duration: PositiveFloat = Field(description="[s], a multiple of the control period")
    seed: NonNegativeInt = Field(default=0, description="of noise and dispersion")
    initial: Initial = Field(default_factory=Initial)
    reference: ReferenceSpec
    controller: ControllerSpec = Field(default_factory=ControllerSpec)
    plant: AnyPlant = Field(default_factory=PlantSpec)
    nominal: NominalSpec = Field(default_factory=NominalSpec, description="what the flight software believes")
    faults: tuple[AnyFault, ...] = Field(default=(), description="what goes wrong in the real robot, and when")
    supervision: SupervisionTable | None = Field(
        default=None, description="modes and monitors; in a file also the name of a shipped table, or a path"
    )
    settling_bands: dict[str, PositiveFloat] = Field(
        default_factory=dict, description="axis -> half width [deg or m] in place of 2 % of its travel"
    )
    expect: dict[str, AnyExpectation] = Field(
        default_factory=dict,
        description="the verdict: metric -> bound, signal -> condition over time, `mode` and `events` -> one per name",
    )

    @model_serializer(mode="wrap")
    def _without_what_is_not(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        # The log of a run without faults and supervision is, to the byte, what it was before there were any.
        return {key: value for key, value in handler(self).items() if key not in ("faults", "supervision") or value}

    @property
    def period(self) -> int:
        """Control period [ns]."""
        return to_nanoseconds(self.control_period, "control_period")

    @property
    def steps(self) -> int:
        """Number of control periods."""
        return steps_of(self.duration, self.control_period)


def load_experiment(name_or_path: StrPath, overrides: Overrides = ()) -> Experiment:
    """Read, override and check an experiment.

    Args:
        name_or_path: a shipped name such as ``liu2023/fig08``, or the path of a YAML file.
        overrides: ``{"controller.gains.lambda": 0.7}``, or ``["controller.gains.lambda=0.7"]`` with values in YAML.

    Returns:
        The experiment; nothing in it can be changed, at any depth.

    Raises:
        InputFileError: there is no such file or shipped experiment.
        SpecError: a key or value cannot be used.
    """
    return read_experiment(name_or_path).experiment(overrides)


@dataclass(frozen=True, slots=True)
class ExperimentFile:
    """An experiment file that has been read and is not yet checked.

    Attributes:
        content: with the base merged in.
        folder: where relative paths in it start.
        where: names it, and its base, in errors.
    """

    content: Mapping[str, Any]
    folder: Path
    where: str

    def experiment(self, overrides: Overrides = ()) -> Experiment:
        """The second half of ``load_experiment``."""
        return experiment_from(self.data(overrides), self.where)

    def data(self, overrides: Overrides = ()) -> dict[str, Any]:
        """The content with overrides, and what stands beside the file found; not checked."""
        given = assignments(overrides)
        # A table may be a name until here, and a key inside of it is one of its content.
        inside = [one for one in given if one.key.startswith("supervision.")]
        data = with_overrides(self.content, [one for one in given if one not in inside])
        data = located(data, self.folder) if inside else data
        return located(with_overrides(data, inside), self.folder)


def read_experiment(name_or_path: StrPath) -> ExperimentFile:
    """Read an experiment file and its base; the first half of ``load_experiment``."""
    path = experiment_path(name_or_path)
    content = parse_yaml(path)
    base = f" (base {content[BASE]})" if BASE in content else ""
    return ExperimentFile(with_base(content, path.parent, str(path)), path.parent, f"{os.fspath(name_or_path)}{base}")


def located(data: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """The mapping with what stands beside its file found: the robot file's path, the numbers of a recorded log."""
    found = dict(data)
    robot, reference, table = found.get("robot"), found.get("reference"), found.get("supervision")
    if isinstance(robot, str) and is_file(folder / robot):
        found["robot"] = str(folder / robot)
    if isinstance(reference, dict):
        found["reference"] = with_recorded_log(reference, folder)
    if isinstance(table, str):
        beside = folder / table
        found["supervision"] = parse_yaml(beside if is_file(beside) else _table_path(table))
    return found


def _table_path(name_or_path: str) -> Path:
    """The file of a shipped supervision table, or the given path."""
    message = "no such supervision table, shipped or as a file"
    return shipped_or_file(name_or_path, "supervision", key="supervision", message=message)


def experiment_from(data: Mapping[str, Any], where: str) -> Experiment:
    """Check a mapping as an experiment; the time base is checked too.

    Raises:
        SpecError: a key or value cannot be used, or there is a base: only files have one, and logs are whole.
    """
    if BASE in data:
        what = "is for experiment files: a resolved experiment is whole"
        raise SpecError(what, key=f"{where} {BASE}", value=data[BASE], accepted="its content")
    experiment = validate(Experiment, dict(data), where)
    _ = experiment.steps
    check_controller(experiment.controller, experiment.control_period)
    return experiment


def experiment_path(name_or_path: StrPath) -> Path:
    """The file of a shipped experiment, or the given path."""
    message = "no such experiment file or shipped experiment"
    return shipped_or_file(name_or_path, "experiments", key="experiment", message=message)


def run_name(name_or_path: StrPath) -> str:
    """What a run of an experiment is called: a shipped one by its full name, ``liu2023/fig08``, a file by its stem."""
    path, shipped = experiment_path(name_or_path).resolve(), (config_dir() / "experiments").resolve()
    return path.relative_to(shipped).with_suffix("").as_posix() if path.is_relative_to(shipped) else path.stem


def file_schema() -> dict[str, Any]:
    """The JSON schema of experiment files, for editors.

    A file with a base may leave out, or say null for, whatever its base has: only its keys can be checked.
    """
    whole = Experiment.model_json_schema()
    definitions = whole.pop("$defs")
    # A model has one of its own.
    del whole["properties"]["supervision"]["title"]
    keys = {name: {"description": spec.get("description", "")} for name, spec in whole["properties"].items()}
    base = {"type": "string", "description": "a YAML file relative to this one, or a shipped experiment"}
    differing = {
        "description": "What differs from a base: sections are merged, null removes a key.",
        "type": "object",
        "properties": {BASE: base, **keys},
        "required": [BASE],
        "additionalProperties": False,
    }
    return {"title": whole["title"], "type": "object", "$defs": definitions, "anyOf": [whole, differing]}


def to_yaml(experiment: Experiment) -> str:
    """The resolved experiment as YAML text with every default written out; equal experiments give equal text."""
    return dump_yaml(experiment.model_dump(mode="json"))


def with_changes(experiment: Experiment, overrides: Overrides) -> Experiment:
    """A loaded experiment with overrides, checked anew; see ``load_experiment``.

    Raises:
        SpecError: a key or value cannot be used.
    """
    if not overrides:
        return experiment
    return experiment_from(with_overrides(experiment.model_dump(mode="json"), overrides), "")


def with_faults(experiment: Experiment, typed: Sequence[str]) -> Experiment:
    """The experiment with more faults, each as ``--fault`` takes it: ``joint_stuck joint=joint2 at=20``.

    Raises:
        SpecError: one is no fault.
    """
    if not typed:
        return experiment
    from space_robot_sim.faults.catalogue import parse_fault

    data = experiment.model_dump(mode="json")
    return experiment_from(data | {"faults": [*data.get("faults", ()), *map(parse_fault, typed)]}, "")


def with_duration(experiment: Experiment, duration: float | None) -> Experiment:
    """The experiment with another duration [s]; None leaves it."""
    if duration is None:
        return experiment
    return experiment_from(experiment.model_dump() | {"duration": duration}, "--duration")
