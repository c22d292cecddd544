"""Data in, typed models out; every complaint is one line that names the key, the value and what would be accepted."""

from __future__ import annotations

import types
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal, TypeVar, Union, get_args, get_origin

from pydantic import BaseModel, ValidationError

from space_robot_description.complaints import accepted_by
from space_robot_description.later import Later
from space_robot_description.yaml_files import nearest as nearest
from space_robot_description.yaml_files import parse_yaml as parse_yaml
from space_robot_description.yaml_files import parse_yaml_text as parse_yaml_text
from space_robot_description.yaml_files import parse_yaml_value as parse_yaml_value
from space_robot_description.yaml_files import short_value
from space_robot_msgs_py.errors import SpaceRobotError, SpecError

Model = TypeVar("Model", bound=BaseModel)


def validate(model_class: type[Model], data: object, where: str) -> Model:
    """Check data against a typed model.

    Args:
        model_class: a pydantic model.
        data: what was parsed.
        where: name of the file, stands before the dotted key in the message; with a dot at its end it is the section
            that the data is in, and a part of the key.

    Raises:
        SpecError: names the first bad key, its value, what is accepted (for an unknown key the nearest valid ones),
            and how many more there are; its ``problems`` are all of them.
    """
    try:
        return model_class.model_validate(data)
    except ValidationError as error:
        raise refusal(model_class, error, data, where) from None


def refusal(model_class: type[BaseModel], error: ValidationError, data: object, where: str) -> SpaceRobotError:
    """What ``validate`` raises, of what pydantic raised."""
    by_path: dict[tuple[str | int, ...], list[Any]] = {}
    # A misspelt key is also a missing one: the spelling is the cause.
    for problem in sorted(error.errors(include_url=False), key=lambda one: one["type"] != "extra_forbidden"):
        by_path.setdefault(_data_path(problem, data), []).append(problem)
    return with_others([_spec_error(model_class, same, path, where) for path, same in by_path.items()])


def with_others(errors: Sequence[SpaceRobotError]) -> SpaceRobotError:
    """The first of some errors, which says how many more there are and has all of them as its ``problems``."""
    first, more = errors[0], len(errors) - 1
    if not more:
        return first
    message = f"{first.message} (and {more} more)"
    summed = type(first)(message, key=first.key, value=first.value, accepted=first.accepted)
    summed.problems = tuple(errors)
    return summed


def _spec_error(
    model_class: type[BaseModel], same: Sequence[Mapping[str, Any]], path: tuple[str | int, ...], where: str
) -> SpecError:
    first = same[0]
    kind = first["type"]
    dotted = ".".join(str(part) for part in path)
    key = f"{where}{dotted}".rstrip(".") if where.endswith(".") else f"{where} {dotted}".strip()
    if kind == "extra_forbidden":
        models = _models_at(model_class, tuple(first["loc"][:-1]))
        for model in models:
            if new := getattr(model, "RENAMED", {}).get(path[-1]):
                return SpecError("was renamed", key=key, accepted=new)
        valid = _valid_keys(models)
        guess = nearest(path[-1], valid)
        accepted = f"did you mean {guess}? valid: {', '.join(valid)}" if guess else ", ".join(valid)
        return SpecError("unknown key", key=key, accepted=accepted)
    if kind == "missing":
        return SpecError("is required and missing", key=key)
    # A value that fits no member of a union yields one problem per member.
    texts = dict.fromkeys(map(accepted_by, same))
    return SpecError("not accepted", key=key, value=short_value(first["input"]), accepted=", or ".join(texts))


def _data_path(problem: Mapping[str, Any], data: object) -> tuple[str | int, ...]:
    """The part of pydantic's location that exists in the data: it also holds union members' names."""
    path: list[str | int] = []
    here = data
    loc = problem["loc"]
    for index, part in enumerate(loc):
        inside = (isinstance(here, Mapping) and part in here) or (
            isinstance(here, Sequence) and not isinstance(here, str) and isinstance(part, int) and part < len(here)
        )
        if inside:
            here = here[part]  # type: ignore[index]
            path.append(part)
        elif index == len(loc) - 1 and problem["type"] == "missing":
            path.append(part)
    return tuple(path)


def _models_at(model_class: type[BaseModel], loc: tuple[str | int, ...]) -> list[type[BaseModel]]:
    candidates: list[type[BaseModel]] = [model_class]
    for part in loc:
        inner = [
            model
            for candidate in candidates
            for name, field in candidate.model_fields.items()
            if part == (field.alias or name)
            for model in _models_in(field.annotation)
        ]
        tagged = [model for model in candidates if part in _tags(model) or part == model.__name__]
        # List indices and mapping keys change nothing: the models inside were collected with the container.
        candidates = inner or tagged or candidates
    return candidates


def _valid_keys(models: Sequence[type[BaseModel]]) -> list[str]:
    keys = (field.alias or name for model in models for name, field in model.model_fields.items())
    return list(dict.fromkeys(keys))


def _models_in(annotation: Any) -> list[type[BaseModel]]:
    if isinstance(annotation, Later):
        return _models_in(annotation.type)
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    if get_origin(annotation) in (Annotated, Union, types.UnionType, tuple, list, dict):
        return [model for part in get_args(annotation) for model in _models_in(part)]
    return []


def _tags(model: type[BaseModel]) -> tuple[Any, ...]:
    """Values of fields that can have only one: what tells the members of a union apart."""
    literals = [
        get_args(info.annotation) for info in model.model_fields.values() if get_origin(info.annotation) is Literal
    ]
    return tuple(values[0] for values in literals if len(values) == 1)
