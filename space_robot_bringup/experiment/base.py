"""``base: NAME_OR_PATH`` in an experiment file: the other file's content, and what this one says differently."""

from __future__ import annotations

import os
from collections.abc import Mapping
from copy import deepcopy
from pathlib import Path
from typing import Any

from space_robot_description.share import config_dir, is_file, shipped
from space_robot_description.yaml_files import nearest, parse_yaml
from space_robot_msgs_py.errors import InputFileError, SpecError

BASE, KIND, LAW, GAINS = "base", "kind", "law", "gains"
FOLDER = "experiments"
# Of an experiment that names none.
DEFAULT_LAW = "computed_torque"


def with_base(data: Mapping[str, Any], folder: Path, where: str) -> dict[str, Any]:
    """The mapping with its base merged in: the same as if everything stood in one file.

    Sections are merged key by key; a value or a list replaces that of the base, and null removes its key. A section of
    another ``kind`` replaces that of the base as a whole; another law drops the gains of the base, as with ``--set``.

    Args:
        data: what the file says; without ``base`` it is returned as it is.
        folder: of the file: a relative base starts there.
        where: names the file in errors.

    Raises:
        SpecError: ``base`` is no name, the file itself, or a file that has a base; or the base is no experiment file.
        InputFileError: there is no such file or shipped experiment.
    """
    own = dict(data)
    if BASE not in own:
        return own
    name, key = own.pop(BASE), f"{where} {BASE}"
    path = _base_path(name, folder, key)
    if path.resolve() == Path(where).resolve():
        raise SpecError("is the file itself", key=key, value=name, accepted="another experiment")
    base = parse_yaml(path)
    if BASE in base:
        what = "has a base of its own, and one level is all there is"
        raise SpecError(what, key=key, value=name, accepted="an experiment without base")
    return _merged(_placed(base, path.parent), own)


def _base_path(name: object, folder: Path, key: str) -> Path:
    if not isinstance(name, str) or not name.strip():
        accepted = "a YAML file relative to this one, or a shipped experiment"
        raise SpecError("not the name of an experiment", key=key, value=name, accepted=accepted)
    for path in (folder / name, config_dir() / FOLDER / f"{name}.yaml"):
        if is_file(path):
            return path
    names = shipped(FOLDER)
    accepted = f"a YAML file relative to this one, or one of: {nearest(name, names) or ', '.join(names)}"
    raise InputFileError("no such file or shipped experiment", key=key, value=name, accepted=accepted)


def _placed(base: dict[str, Any], folder: Path) -> dict[str, Any]:
    """The content of a base with paths that are relative to it made absolute: its reader may stand elsewhere."""
    robot, reference = base.get("robot"), base.get("reference")
    if isinstance(robot, str) and is_file(folder / robot):
        base["robot"] = os.path.abspath(folder / robot)
    if isinstance(reference, dict) and isinstance(log := reference.get("log"), str):
        base["reference"] = reference | {"log": os.path.abspath(folder / log)}
    return base


def _merged(base: Mapping[str, Any], own: Mapping[str, Any]) -> dict[str, Any]:
    if KIND in own and KIND in base and own[KIND] != base[KIND]:
        return deepcopy(dict(own))
    found: dict[str, Any] = deepcopy(dict(base))
    for key, value in own.items():
        if value is None and key in found:
            del found[key]
        elif isinstance(value, dict) and isinstance(found.get(key), dict):
            below = _without_gains(found[key], value) if key == "controller" else found[key]
            found[key] = _merged(below, value)
        else:
            found[key] = deepcopy(value)
    return found


def _without_gains(base: Mapping[str, Any], own: Mapping[str, Any]) -> Mapping[str, Any]:
    before = base.get(LAW, DEFAULT_LAW)
    return base if own.get(LAW, before) == before else {key: value for key, value in base.items() if key != GAINS}
