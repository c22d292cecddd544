"""What a supervisor costs headless: a supervised tick over one that is not, in one run of this benchmark."""

from __future__ import annotations

import gc
from collections.abc import Iterator, Mapping
from statistics import median
from time import thread_time
from typing import Any

from space_robot_bringup.compose.composition import Composition, compose
from space_robot_bringup.experiment.experiment import load_experiment, with_duration
from space_robot_bringup.modes import headless
from space_robot_description.share import config_dir
from space_robot_description.validation import parse_yaml
from space_robot_msgs_py.interfaces import Tick

CASE, TABLE = "liu2023/fig08", "mini_basic"
MONITORS, PERIODS = 20, 8000
# Where no monitor of the table fires.
SPARE = (
    ("base.speed", 9.0),
    ("error.position", 99.0),
    ("error.joints", 9.0),
    ("wheels.momentum", 999.0),
    ("telemetry.joint_error", 9.0),
    ("rate.y", 9.0),
    ("rate.z", 9.0),
    ("joint.rate.joint1", 9.0),
    ("joint.rate.joint2", 9.0),
    ("joint.position.joint1", 9.0),
    ("joint.position.joint2", 9.0),
    ("joint.position.joint3", 9.0),
    ("joint.position.joint4", 9.0),
)


def table(monitors: int) -> dict[str, Any]:
    """The shipped table with so many monitors, all of which are looked at in its first mode."""
    found = dict(parse_yaml(config_dir() / "supervision" / f"{TABLE}.yaml"))
    rows = [row for row in found["monitors"] if "NOMINAL" in row.get("in", ["NOMINAL"])]
    others = [row for row in found["monitors"] if row not in rows]
    for index, (value, bound) in enumerate(SPARE[: monitors - len(rows)]):
        rows.append({"name": f"spare_{index}", "value": value, "above": bound, "in": ["NOMINAL"]})
    return found | {"monitors": [*rows, *others]}


def course(composition: Composition) -> Iterator[Tick]:
    """Its ticks, each computed when it is asked for."""
    parts = composition.plant(), composition.controller(), composition.reference()
    return headless.ticks(*parts, steps=PERIODS, supervisor=composition.supervisor())


def medians(compositions: Mapping[str, Composition]) -> dict[str, float]:
    """CPU time of a control period [s], of each the median: ticks in turn, so that all meet the same machine."""
    courses = {name: course(composition) for name, composition in compositions.items()}
    times: dict[str, list[float]] = {name: [] for name in courses}
    gc.collect()
    gc.disable()
    for _ in range(PERIODS + 1):
        for name, ticks in courses.items():
            begin = thread_time()
            tick = next(ticks)
            times[name].append(thread_time() - begin)
            assert tick.supervision is None or not tick.supervision.events
    gc.enable()
    return {name: median(found) for name, found in times.items()}


def run() -> dict[str, float]:
    """Microseconds per control period without and with a supervisor, and their ratio."""
    experiment = load_experiment(CASE)
    experiment = with_duration(experiment, PERIODS * experiment.period / 1e9)
    data = experiment.model_dump(by_alias=True)
    tables: Mapping[str, Any] = {
        "alone": None,
        f"{TABLE}": TABLE,
        f"{MONITORS} monitors": table(MONITORS),
    }
    compositions = {}
    for name, section in tables.items():
        overrides = {"duration": data["duration"], "supervision": section}
        compositions[name] = compose(load_experiment(CASE, overrides))
    found = medians(compositions)
    rows = {f"{CASE}, {name}: us per period": 1e6 * value for name, value in found.items()}
    ratios = {f"{CASE}, {name}: over alone": value / found["alone"] for name, value in found.items() if name != "alone"}
    return rows | ratios
