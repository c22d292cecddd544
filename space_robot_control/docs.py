"""The tables in docs/laws, from the models of the gains and the telemetry of a first update.

A page has ``<!-- gains of LAW ... -->`` or ``<!-- telemetry of LAW ... -->``, a table, ``<!-- end -->``;
``python -m space_robot_control.docs docs/laws/*.md`` brings the tables up to date.
"""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

import numpy as np
from annotated_types import Ge, Gt, Le, Lt, MinLen
from pydantic import BaseModel

from space_robot_control.laws import law_class, make_law
from space_robot_control.per_dof import OneForAll
from space_robot_description.load import load_robot
from space_robot_msgs_py.interfaces import Reference, RobotState

ROBOTS = ("mini", "servicer")  # free-floating and free-flying
_TABLE = re.compile(r"(<!-- (gains|telemetry) of (\w+)(?: beyond (\w+))?\b[^>]*-->\n).*?(<!-- end -->)", re.DOTALL)
_BOUNDS = {Gt: ("gt", ">"), Ge: ("ge", ">="), Lt: ("lt", "<"), Le: ("le", "<=")}
_KINDS: dict[Any, str] = {bool: "true, false", int: "integer", float: "number", str: "text", NoneType: "null"}
Row = tuple[str, ...]


def filled(page: str) -> str:
    """Return the page with its tables up to date."""

    def table(found: re.Match[str]) -> str:
        begin, kind, law, base, end = found.groups()
        return f"{begin}\n{gains_table(law, base) if kind == 'gains' else telemetry_table(law)}\n{end}"

    return _TABLE.sub(table, page)


def gains_table(law: str, base: str | None = None) -> str:
    """Return a Markdown table of the gains of a law, without those of a base law."""
    rows = list(_rows_of(law))
    if base is not None:
        known = {row[0] for row in _gain_rows(law_class(base).Gains, {})}
        rows = [row for row in rows if row[0] not in known]
    return _markdown(("gain", "default", "accepted", "changes in a run", "meaning"), rows)


def gain_rows(law: str) -> Iterator[Row]:
    """Each gain of a law in plain text: key, default, accepted values, ``changes in a run`` or nothing, meaning."""
    for key, default, accepted, changes, text in _rows_of(law):
        yield key.strip("`"), default, accepted.replace("`", ""), "changes in a run" * bool(changes), text


def telemetry_table(law: str) -> str:
    """Return a Markdown table of the telemetry of a law with its default gains."""
    fields, sizes = law_class(law).telemetry_fields, [_sizes(law, robot) for robot in ROBOTS]
    rows = [(f"`{label}`", *(str(size.get(label, "-")) for size in sizes), text) for label, text in fields.items()]
    return _markdown(("block", *(f"on `{robot}`" for robot in ROBOTS), "meaning"), rows)


def _sizes(law: str, name: str) -> dict[str, int]:
    robot = load_robot(name)
    q, still = np.array([0, 0, 0, 0, 0, 0, 1.0, *robot.home]), np.zeros(6 + robot.n)
    state = RobotState(0, q, still, np.zeros(robot.n), np.zeros(3))
    telemetry = make_law(law, robot, 0.25).update(state, Reference(0, q, still, still)).telemetry
    return dict(zip(telemetry.labels, telemetry.sizes, strict=True))


def _rows_of(law: str) -> Iterator[Row]:
    model = law_class(law).Gains
    return _gain_rows(model, model().model_dump(mode="json", by_alias=True))


def _gain_rows(
    model: type[BaseModel], defaults: Mapping[str, Any], prefix: str = "", dynamic: bool = False
) -> Iterator[Row]:
    for name, info in model.model_fields.items():
        key, extra = info.alias or name, info.json_schema_extra
        value = defaults.get(key)
        changes = dynamic or (isinstance(extra, dict) and bool(extra.get("dynamic")))
        annotation = Annotated[info.annotation, *info.metadata] if info.metadata else info.annotation
        section = _section(annotation)
        default = "" if section is not None and value is not None else json.dumps(value)
        yield f"`{prefix}{key}`", default, _accepted(annotation), "yes" if changes else "", info.description or ""
        if section is not None:
            inside = value if isinstance(value, dict) else section().model_dump(mode="json", by_alias=True)
            yield from _gain_rows(section, inside, f"{prefix}{key}.", changes)


def _section(annotation: Any) -> type[BaseModel] | None:
    """The model that a field is, or may be."""
    parts = get_args(annotation) if get_origin(annotation) in (Union, UnionType) else (annotation,)
    return next((part for part in parts if isinstance(part, type) and issubclass(part, BaseModel)), None)


def _accepted(annotation: Any) -> str:
    """What a field takes, in words."""
    origin, arguments = get_origin(annotation), get_args(annotation)
    if origin in (Union, UnionType):
        return " or ".join(dict.fromkeys(map(_accepted, arguments)))
    if origin is Literal:
        return ", ".join(f"`{choice}`" for choice in arguments)
    if origin is Annotated:
        constraints = [part for item in arguments[1:] for part in getattr(item, "metadata", (item,))]
        return _constrained(arguments[0], constraints)
    if origin is tuple:
        kinds = set(arguments) - {Ellipsis}
        return f"list of {'' if Ellipsis in arguments else f'{len(arguments)}: '}{_accepted(kinds.pop())}"
    if origin is dict:
        return f"by name: {_accepted(arguments[1])}"
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return "section or number" if issubclass(annotation, OneForAll) else "section"
    return _KINDS[annotation]


def _constrained(annotation: Any, constraints: list[Any]) -> str:
    length = next((part.min_length for part in constraints if isinstance(part, MinLen)), 0)
    if length:
        return f"list of {length}: {_accepted(get_args(annotation)[0])}"
    known = [(_BOUNDS[type(part)], part) for part in constraints if type(part) in _BOUNDS]
    bounds = ", ".join(f"{sign} {getattr(part, name):g}" for (name, sign), part in known)
    return f"{'integer ' if annotation is int else ''}{bounds}" if bounds else _accepted(annotation)


def _markdown(head: Row, rows: list[Row]) -> str:
    lines = [head, tuple("---" for _ in head), *(tuple(cell.replace("|", "\\|") for cell in row) for row in rows)]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


if __name__ == "__main__":
    for path in map(Path, sys.argv[1:]):
        path.write_text(filled(path.read_text(encoding="utf-8")), encoding="utf-8")
