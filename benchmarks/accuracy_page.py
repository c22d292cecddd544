"""The page docs/accuracy.md, of numbers that ``benchmarks.accuracy`` measured."""

from __future__ import annotations

import os
import platform
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

HEAD = """# Accuracy beside other engines

<!-- Written by `python -m benchmarks.accuracy docs/accuracy.md`. -->

The same robot with the same held joint efforts in this plant, in [MuJoCo](https://github.com/google-deepmind/mujoco),
and in the scenes that [Basilisk](https://github.com/AVSLab/basilisk) has on top of MuJoCo. It floats freely with some
momentum, its joints swing at 0.05 to 0.1 Hz for {seconds:g} s, and efforts change every 0.1 s, as commands of flight
software do. ANYmal and the UR5 are those of the `example-robot-data` wheel, on a satellite of 300 kg.

- **error**: the largest difference in the configuration at the end [m, rad] from a reference that shares no code with
  any of them: scipy's DOP853 at a relative tolerance of 1e-13 over Pinocchio's forward dynamics. The last row of each
  table says how far that reference moves at 1e-12; errors below it mean nothing.
- **momentum**: lost of linear or angular momentum about the origin, as a share of what there was; no force acts from
  outside.
- **us**: microseconds of CPU time for one period of 0.1 s, called from Python period by period, as a controller does;
  the median of runs in which the engines took turns. Ours is `SimulatedRobot.step`, with its actuators, sensors and
  balances of momentum and energy.

Every engine is shown at settings that favour it: contacts off in MuJoCo, `highOrderAttitudeIntegration` on in Basilisk
(off, which is its default, the momentum of these runs is good to 1e-5 whatever the tolerance), one integration per
period where a tolerance decides the step, and the fixed step that others use most.
"""
TAIL = """
## What to make of it

- At equal fixed steps MuJoCo and Basilisk have equal errors where the step decides them: the robots are the same, and
  only the integration differs. Where an error of Basilisk depends on neither integrator nor tolerance, its copy of the
  robot has other last digits; we have not found out where they come from.
- A robot in free fall is smooth between two commands, which pays for a method of high order: this plant's default is
  two steps of order eight per period. Contacts, for which MuJoCo is made, are not smooth, and this plant has none.
- Machines differ and neighbours are noisy: compare rows of one table, not numbers of two pages. `make bench` shows more
  of this plant ([speed](speed.md)).

Again on your machine: `python -m benchmarks.accuracy docs/accuracy.md`, some minutes. The engines are installed into
an environment of their own below `out`, and are no dependencies of this project.
"""
_MODEL = "model name"


@dataclass(frozen=True, slots=True)
class Row:
    """One engine on one robot.

    Attributes:
        name: engine and settings.
        microseconds: per period of 0.1 s; None: not of interest.
        error: of the configuration at the end [m, rad].
        drift: of the momentum, relative [-].
    """

    name: str
    microseconds: float | None
    error: float
    drift: float


def page(tables: Mapping[str, Sequence[Row]], versions: Mapping[str, str], seconds: float) -> str:
    """The whole page.

    Args:
        tables: rows by robot.
        versions: of the other engines; one that is not there was not installed.
        seconds: that a run takes.
    """
    parts = [HEAD.format(seconds=seconds), _machine(versions)]
    for name, rows in tables.items():
        parts.append(f"\n## {name}\n\n| engine | us | error | momentum |\n|---|---|---|---|\n")
        for row in rows:
            time = "" if row.microseconds is None else f"{row.microseconds:.0f}"
            parts.append(f"| {row.name} | {time} | {row.error:.1e} | {row.drift:.1e} |\n")
    return "".join([*parts, TAIL])


def _machine(versions: Mapping[str, str]) -> str:
    known = {"MuJoCo": versions.get("mujoco"), "Basilisk": versions.get("bsk")}
    engines = [f"{name} {found}" if found else f"{name} not installable here" for name, found in known.items()]
    own = [f"{name} {version(name)}" for name in ("pin", "scipy", "numba")]
    what = [f"CPython {platform.python_version()}", *engines, *own]
    return f"\nMachine: {_processor()}, {os.cpu_count()} cores, {platform.system()}. {', '.join(what)}.\n"


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.machine()
    return next((line.partition(":")[2].strip() for line in lines if line.startswith(_MODEL)), platform.machine())
