"""``python -m benchmarks.accuracy docs/accuracy.md``: this plant beside MuJoCo and Basilisk, as a page.

The engines run in an environment of their own, ``out/peers`` (about 700 MB), which is made where it is not there; what
cannot be installed there is left out and said. Contenders take turns, so that a neighbour's load hits all of them.
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from statistics import median
from time import process_time
from typing import Any

import numpy as np

from benchmarks.accuracy_page import Row, page
from benchmarks.accuracy_tasks import PERIOD, PERIODS, ROBOTS, Task, drift, error, task, truth
from space_robot_msgs_py.interfaces import Command, Vector
from space_robot_sim.plant import InitialState, SimulatedRobot
from space_robot_sim.spec import IntegratorSpec
from tests.support.robots import robot_of

ROOT = Path(__file__).resolve().parents[1]
ROUNDS = 7
OURS = {
    "this plant, default": IntegratorSpec(),
    "this plant, `dop853_adaptive` 1e-12": IntegratorSpec(kind="dop853_adaptive", rtol=1e-12, atol=1e-14),
}
THEIRS: dict[str, dict[str, Any]] = {
    "MuJoCo, RK4 5 ms": {"engine": "mujoco", "step": 0.005},
    "MuJoCo, RK4 1 ms": {"engine": "mujoco", "step": 0.001},
    "Basilisk, RKF78 default": {"engine": "bsk", "kind": "RKF78", "step": 0.1, "tolerance": None},
    "Basilisk, RKF78 1e-10": {"engine": "bsk", "kind": "RKF78", "step": 0.1, "tolerance": 1e-10},
    "Basilisk, RK4 5 ms": {"engine": "bsk", "kind": "RK4", "step": 0.005, "tolerance": None},
}
# CPU seconds per period, and state at the end.
Contender = Callable[[], tuple[float, Vector, Vector]]


class Peers:
    """The engines in a process of their own."""

    def __init__(self, python: Path) -> None:
        script = str(ROOT / "benchmarks" / "peers" / "engines.py")
        self._process = subprocess.Popen(
            [str(python), script], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
        )
        self.versions: dict[str, str] = self._read()

    def run(self, message: dict[str, Any], how: dict[str, Any]) -> tuple[float, Vector, Vector]:
        """One run of a task."""
        assert self._process.stdin is not None
        print(json.dumps({"task": message, **how}), file=self._process.stdin, flush=True)
        found = self._read()
        qpos, qvel = np.array(found["qpos"]), np.array(found["qvel"])
        q = np.concatenate([qpos[:3], np.roll(qpos[3:7], -1), qpos[7:]])
        # Their linear velocity is in the world's axes.
        return found["seconds"], q, np.concatenate([turned_back(q[3:7], qvel[:3]), qvel[3:]])

    def close(self) -> None:
        """End the process."""
        assert self._process.stdin is not None
        self._process.stdin.close()
        self._process.wait()

    def _read(self) -> dict[str, Any]:
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        if not line:
            raise RuntimeError("the process of the engines ended")
        found: dict[str, Any] = json.loads(line)
        return found


def main() -> int:
    """Run everything and write the page."""
    if len(sys.argv) != 2:
        print("usage: python -m benchmarks.accuracy PAGE.md", file=sys.stderr)
        return 2
    peers = Peers(_environment(ROOT / "out" / "peers"))
    tables = {name: table(task(name), peers) for name in ROBOTS}
    peers.close()
    Path(sys.argv[1]).write_text(page(tables, peers.versions, 1e-9 * PERIOD * PERIODS), encoding="utf-8")
    return 0


def table(one: Task, peers: Peers | None) -> list[Row]:
    """All engines on one task."""
    q_true, v_true = truth(one)
    contenders: dict[str, Contender] = {name: _plant(one, how) for name, how in OURS.items()}
    if peers is not None:
        message = one.message
        for name, how in THEIRS.items():
            if how["engine"] in peers.versions:
                contenders[name] = lambda how=how: peers.run(message, how)
    seconds: dict[str, list[float]] = {name: [] for name in contenders}
    ends: dict[str, tuple[Vector, Vector]] = {}
    for _ in range(ROUNDS):
        for name, contender in contenders.items():
            took, *end = contender()
            seconds[name].append(took)
            ends[name] = end[0], end[1]
    rows = [Row(name, 1e6 * median(seconds[name]), error(q, q_true), drift(one, q, v)) for name, (q, v) in ends.items()]
    again = truth(one, 1e-12)[0]
    return [*rows, Row("reference: DOP853 1e-13, beside 1e-12", None, error(again, q_true), drift(one, q_true, v_true))]


def _plant(one: Task, how: IntegratorSpec) -> Contender:
    robot, initial = robot_of(one.model, floating=True), InitialState(one.q, one.v)
    plant = SimulatedRobot(robot, control_period=PERIOD, initial=initial, integrator=how)
    commands = [Command(k * PERIOD, np.zeros(6), effort) for k, effort in enumerate(one.efforts)]

    def contender() -> tuple[float, Vector, Vector]:
        sample = plant.reset()
        began = process_time()
        for command in commands:
            sample = plant.step(command)
        return (process_time() - began) / len(commands), sample.state.q, sample.state.v

    return contender


def turned_back(quaternion: Vector, vector: Vector) -> Vector:
    """A vector of the world in the axes of a body."""
    axis, w = -quaternion[:3], quaternion[3]
    out: Vector = vector + 2.0 * np.cross(axis, np.cross(axis, vector) + w * vector)
    return out


def _environment(folder: Path) -> Path:
    """The Python of the engines' environment, made where there is none."""
    python = folder / "bin" / "python"
    if not python.exists():
        subprocess.run([sys.executable, "-m", "venv", str(folder)], check=True)
        for package in ("mujoco", "bsk"):
            # One after the other: not every engine has a wheel for every Python.
            subprocess.run([str(python), "-m", "pip", "install", "--quiet", package], check=False)
    return python


if __name__ == "__main__":
    sys.exit(main())
