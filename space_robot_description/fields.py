"""Typed models as flat lists of parameters, and the same models with some of their fields changed."""

from __future__ import annotations

import types
from collections.abc import Iterator, Mapping
from typing import Annotated, Any, TypeVar, Union, get_args, get_origin

from annotated_types import Ge, Gt, Le, Lt
from pydantic import BaseModel

from space_robot_description.validation import nearest, validate
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.parameters import ParameterRow

Model = TypeVar("Model", bound=BaseModel)
# Marks a field that may change during the run: Field(..., json_schema_extra=DYNAMIC). On a section: all in it.
DYNAMIC: dict[str, Any] = {"dynamic": True}


def parameter_rows(model: BaseModel, prefix: str = "", *, dynamic: bool = False) -> Iterator[ParameterRow]:
    """One row for each number, text or list in a model, sections of it under dotted names.

    Args:
        model: a typed model with all its values.
        prefix: stands before every name, with its dot.
        dynamic: every field may change during the run, whatever it says of itself.
    """
    plain = model.model_dump(mode="json", by_alias=True)
    for name, info in type(model).model_fields.items():
        key, value = info.alias or name, getattr(model, name)
        if key not in plain:
            # The model says nothing of it, as an experiment without faults.
            continue
        extra = info.json_schema_extra
        may_change = dynamic or (isinstance(extra, dict) and bool(extra.get("dynamic")))
        if isinstance(value, BaseModel):
            yield from parameter_rows(value, f"{prefix}{key}.", dynamic=may_change)
            continue
        lower, upper = _bounds(Annotated[info.annotation, *info.metadata] if info.metadata else info.annotation)
        yield ParameterRow(f"{prefix}{key}", plain[key], info.description or _said_of(model), may_change, lower, upper)


def changed(model: Model, changes: Mapping[str, Any], where: str) -> Model:
    """The model with other values for some of its dynamic fields, validated as a whole.

    Args:
        model: stays as it is.
        changes: dotted name to new value.
        where: stands before the names in errors, with its dot.

    Raises:
        SpecError: no such field, one that is not dynamic, or a value that is not accepted.
    """
    data = model.model_dump(mode="json", by_alias=True)
    rows = {row.name: row for row in parameter_rows(model)}
    for name, value in changes.items():
        if name not in rows:
            may = [row.name for row in rows.values() if row.dynamic]
            accepted = nearest(name, may) or ", ".join(may) or "nothing: it has no dynamic gains"
            raise SpecError("there is no such number to change", key=f"{where}{name}", accepted=accepted)
        if not rows[name].dynamic:
            raise SpecError("cannot change during the run", key=f"{where}{name}", value=value)
        *sections, last = name.split(".")
        place = data
        for section in sections:
            place = place[section]
        place[last] = value
    return validate(type(model), data, where)


def _said_of(model: BaseModel) -> str:
    """What tells the members of a union apart is explained by the member it stands for."""
    return (type(model).__doc__ or "").partition("\n")[0]


def _bounds(annotation: Any) -> tuple[float | None, float | None]:
    """Lower and upper bound of the number that an annotation describes, or that a union has as a member."""
    lower = upper = None
    if get_origin(annotation) is Annotated:
        inner, *metadata = get_args(annotation)
        lower, upper = _bounds(inner)
        for constraint in _flat(metadata):
            if isinstance(constraint, Ge | Gt):
                lower = float(constraint.ge if isinstance(constraint, Ge) else constraint.gt)  # type: ignore[arg-type]
            if isinstance(constraint, Le | Lt):
                upper = float(constraint.le if isinstance(constraint, Le) else constraint.lt)  # type: ignore[arg-type]
    elif get_origin(annotation) in (Union, types.UnionType):
        numbers = [part for part in get_args(annotation) if _is_number(part)]
        if numbers:
            lower, upper = _bounds(numbers[0])
    return lower, upper


def _flat(metadata: list[Any]) -> Iterator[Any]:
    for item in metadata:
        # A Field(ge=...) inside Annotated keeps its constraints in a list of its own.
        yield from getattr(item, "metadata", (item,))


def _is_number(annotation: Any) -> bool:
    inner = get_args(annotation)[0] if get_origin(annotation) is Annotated else annotation
    return inner in (int, float)
