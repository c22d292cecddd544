"""What is shipped, with a line on each.

The lines come from the files as they are: to check all of them as their runs do takes a second, and `check` does it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from space_robot_bringup.experiment.base import with_base
from space_robot_description.joint_count import count_joints
from space_robot_description.share import config_dir, shipped
from space_robot_description.yaml_files import nearest, parse_yaml
from space_robot_msgs_py.bounded_files import read_text
from space_robot_msgs_py.errors import SpaceRobotError, SpecError
from space_robot_msgs_py.limits import YAML_BYTES
from space_robot_msgs_py.yaml_heads import top_texts
from space_robot_studies.campaign.run_count import runs_of


def catalogue(kind: str = "", beginning: str = "") -> dict[str, dict[str, str]]:
    """Kind to name to one line, of one kind or of all, of the names that begin with a text.

    Raises:
        SpecError: there is no such kind, or none of it begins so.
    """
    says = {
        "experiments": _experiment,
        "papers": _paper,
        "campaigns": _campaign,
        "tuning": _tuning,
        "benchmarks": _benchmark,
        "supervision": _table,
        "robots": _robot,
    }
    if kind and kind not in says:
        raise SpecError("no such kind", key="KIND", value=kind, accepted=", ".join((*says, *EXPLAINED)))
    return {
        one: {name: say(name) for name in _beginning(shipped(one), beginning)}
        for one, say in says.items()
        if kind in ("", one)
    }


def faults(beginning: str = "") -> Iterator[str]:
    """Every kind of fault with its keys, as lines."""
    # Here, because models of all files take their time to be made, and only these lines need them.
    from space_robot_sim.faults.catalogue import common_keys, groups, keys_of, meaning

    wanted = _beginning([kind for kinds in groups().values() for kind in kinds], beginning)
    for group, kinds in groups().items():
        if not set(kinds).isdisjoint(wanted):
            yield group
        for kind in (one for one in kinds if one in wanted):
            yield f"  {kind:<22}{meaning(kind)}"
            for key in keys_of(kind):
                default = f" (default {key.default})" if key.default else ""
                yield f"    {key.name:<20}{key.meaning}{default}"
    yield "all"
    for key in common_keys():
        yield f"    {key.name:<20}{key.meaning}"


def laws(beginning: str = "") -> Iterator[str]:
    """Every law with its gains, as lines."""
    # Here, because a law is code: numba and Pinocchio take their time to load.
    from space_robot_control.docs import gain_rows
    from space_robot_control.laws import law_class, law_names

    for name in _beginning(law_names(), beginning):
        yield f"{name:<24}{(law_class(name).__doc__ or '').strip().splitlines()[0]}"
        for key, default, accepted, changes, text in gain_rows(name):
            inside = "; ".join(filter(None, (f"default {default}" * bool(default), accepted, changes)))
            yield f"    {key:<26}{text} ({inside})"


# What is no file but code, and explained with its keys.
EXPLAINED = {"laws": laws, "faults": faults}


def _beginning(names: Sequence[str], beginning: str) -> list[str]:
    found = [name for name in names if name.startswith(beginning)]
    if names and not found:
        close = nearest(beginning, names)
        raise SpecError("none begins so", key="NAME", value=beginning, accepted=close or ", ".join(names))
    return found


def _experiment(name: str) -> str:
    head: Mapping[str, Any] = _head("experiments", name, "title", "source")
    if len(head) < 2:
        path = _path("experiments", name)
        head = with_base(parse_yaml(path), path.parent, str(path))
    title, source = _line(head, "title"), _line(head, "source")
    return f"{title} ({source})" if source else title


def _paper(name: str) -> str:
    head = _head("papers", name, "title", "citation")
    return f"{_line(head, 'title')} ({_line(head, 'citation')})"


def _benchmark(name: str) -> str:
    return _line(_head("benchmarks", name, "title"), "title")


def _tuning(name: str) -> str:
    return _line(_head("tuning", name, "title"), "title")


def _campaign(name: str) -> str:
    spec = _content("campaigns", name)
    return f"{runs_of(spec)} runs: {_line(spec, 'title')}"


def _table(name: str) -> str:
    return _line(_head("supervision", name, "title"), "title")


def _robot(name: str) -> str:
    data, folder = _content("robots", name), config_dir() / "robots"
    # A robot whose arm comes with a package that is not installed here is shipped all the same.
    try:
        joints = count_joints(data, folder)
    except SpaceRobotError as error:
        return f"not available here: {error}"
    return f"{joints} joints, {_line(data, 'base_mode')}; {_line(data, 'description')}"


def _path(kind: str, name: str) -> Path:
    return config_dir() / kind / f"{name}.yaml"


def _content(kind: str, name: str) -> dict[str, Any]:
    return parse_yaml(_path(kind, name))


def _head(kind: str, name: str, *keys: str) -> dict[str, str]:
    path = _path(kind, name)
    return top_texts(read_text(path, YAML_BYTES), keys, str(path))


def _line(data: Mapping[str, Any], key: str) -> str:
    return str(data.get(key, ""))
