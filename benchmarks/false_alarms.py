"""No false alarm: nominal tasks of dispersed robots with noisy sensors under every shipped table, 0 changes of mode.

python -m benchmarks.false_alarms [ROBOTS [PERIODS [FILE]]]

With a FILE what is found of each robot is a line of it, and what it has already is not run again, so that it may be
interrupted at any time and goes on.
"""

from __future__ import annotations

import json
import sys
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes import headless
from space_robot_description.load import load_robot
from space_robot_description.share import shipped
from space_robot_msgs_py.interfaces import PlantSample, Reference, Supervision, Tick

ROBOTS, PERIODS = 100, 10_000
NOISE = ("attitude", "angular_velocity", "joint_position", "joint_velocity", "position", "linear_velocity")
SPREAD = ("bodies.*.mass", "bodies.*.com", "bodies.*.inertia", "joints.*.effort")
AMPLITUDES = {"mini": 20.0, "servicer": 10.0}


@dataclass
class Watcher:
    """A sink that keeps nothing but what the supervisor reported."""

    events: Counter[str]
    modes: set[str]
    ticks: int = 0
    end_reason: str = ""

    def record(self, tick: Tick) -> None:
        """Count."""
        assert tick.supervision is not None
        self.ticks += 1
        self.modes.add(tick.supervision.mode)
        self.events.update(f"{event.name} {event.message}" for event in tick.supervision.events)

    def record_unanswered(
        self, sample: PlantSample, reference: Reference, supervision: Supervision | None = None
    ) -> None:
        """Nothing to count."""

    def close(self, reason: str) -> None:
        """Keep the reason."""
        self.end_reason = reason


def nominal(table: str, seed: int, periods: int) -> dict[str, Any]:
    """A moving task for the robot that a table is made for, with one draw of everything."""
    robot = table.partition("_")[0]
    swing = {"amplitude_deg": AMPLITUDES[robot], "frequency": 0.04}
    joints = {name: swing | {"phase_deg": 90.0 * index} for index, name in enumerate(load_robot(robot).joint_names)}
    return {
        "supervision": table,
        "seed": seed,
        "duration": 0.25 * periods,
        "reference": {
            "kind": "harmonic",
            "soft_start": 20.0,
            "yaw": {"amplitude_deg": 10.0, "frequency": 0.01},
            "pitch": {"amplitude_deg": 5.0, "frequency": 0.01, "phase_deg": 90.0},
            "joints": joints,
        },
        "plant.dispersion": {"parameters": dict.fromkeys(SPREAD, 0.05)},
        **{f"plant.sensors.{channel}.noise": 1e-4 for channel in NOISE},
    }


def watch(table: str, seed: int, periods: int) -> Watcher:
    """Run one robot for so many periods."""
    composition = compose(load_experiment(f"compare/{table.partition('_')[0]}", nominal(table, seed, periods)))
    watcher = Watcher(Counter(), set())
    headless.run(
        composition.plant(),
        composition.controller(),
        composition.reference(),
        steps=periods,
        sink=watcher,
        supervisor=composition.supervisor(),
    )
    return watcher


def found(table: str, seed: int, periods: int) -> dict[str, Any]:
    """What a robot showed, as plain data."""
    watcher = watch(table, seed, periods)
    key = {"table": table, "seed": seed, "periods": periods}
    return key | {"end": watcher.end_reason, "modes": sorted(watcher.modes), "events": dict(watcher.events)}


def known(path: Path | None) -> dict[tuple[str, int, int], dict[str, Any]]:
    """What a file has of robots, by table, seed and periods; a line that was cut is none."""
    rows = []
    for line in path.read_text().splitlines() if path is not None and path.exists() else ():
        try:
            rows.append(json.loads(line))
        except ValueError:
            continue
    return {(row["table"], row["seed"], row["periods"]): row for row in rows}


def main(arguments: list[str]) -> int:
    """Run all tables; 1 where a mode changed or a run did not complete."""
    robots, periods = (int(one) for one in (*arguments[:2], *(ROBOTS, PERIODS)[len(arguments[:2]) :]))
    path = Path(arguments[2]) if len(arguments) > 2 else None
    rows, wrong = known(path), 0
    for table in shipped("supervision"):
        events: Counter[str] = Counter()
        for seed in range(robots):
            row = rows.get((table, seed, periods)) or found(table, seed, periods)
            if path is not None and (table, seed, periods) not in rows:
                with path.open("a") as file:
                    file.write(f"{json.dumps(row)}\n")
            events.update(row["events"])
            if row["end"] != "completed" or row["modes"] != ["NOMINAL"]:
                wrong += 1
                print(f"{table}, seed {seed}: {row['end']}, {row['modes']}, {row['events']}")
        print(f"{table}: {robots} robots x {periods} periods, events: {dict(events) or 'none'}", flush=True)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
