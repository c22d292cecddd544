"""What is shipped, with a line on each."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_description.load import load_robot
from space_robot_description.share import config_dir, shipped
from space_robot_description.validation import nearest, parse_yaml, validate
from space_robot_msgs_py.errors import SpaceRobotError, SpecError
from space_robot_sim.faults.catalogue import common_keys, groups, keys_of, meaning
from space_robot_studies.benchmark.spec import load_benchmark
from space_robot_studies.campaign.spec import read_campaign
from space_robot_studies.reproduce.plan import manifest_path, read_manifest
from space_robot_studies.tune.spec import read_tuning
from space_robot_supervisor.table import SupervisionTable


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
    spec = load_experiment(name)
    return f"{spec.title} ({spec.source})" if spec.source else spec.title


def _paper(name: str) -> str:
    manifest = read_manifest(manifest_path(name), name)
    return f"{manifest.title} ({manifest.citation})"


def _benchmark(name: str) -> str:
    return load_benchmark(name).title


def _tuning(name: str) -> str:
    return read_tuning(name).title


def _campaign(name: str) -> str:
    spec = read_campaign(name)
    return f"{spec.runs} runs: {spec.title}"


def _table(name: str) -> str:
    return validate(SupervisionTable, parse_yaml(config_dir() / "supervision" / f"{name}.yaml"), name).title


def _robot(name: str) -> str:
    # A robot whose arm comes with a package that is not installed here is shipped all the same.
    try:
        robot = load_robot(name)
    except SpaceRobotError as error:
        return f"not available here: {error}"
    return f"{robot.n} joints, {robot.base_mode}; {robot.resolved['description']}"
