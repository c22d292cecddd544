"""A run is measured while its ticks come in: the same bits as from whole arrays, and little is kept of each tick."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from space_robot_bringup.judge import measure as measuring
from space_robot_bringup.judge.judging import log_block
from space_robot_bringup.judge.measure import Measurement
from space_robot_msgs_py.interfaces import Command, ControlOutput, PlantSample, Reference, RobotState, Telemetry, Tick
from space_robot_msgs_py.log.header import LogHeader
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.log.writer import LogSink
from tests.support.whole_metrics import measure, measure_whole

PERIOD = 100_000_000


def random_ticks(rng: np.random.Generator, count: int, joints: int, *, settles: bool) -> list[Tick]:
    """A run whose every number is drawn; with a reference that stands still at its end, or goes on."""
    goal, ticks = _configuration(rng, joints), []
    for k in range(count):
        stamp, nearness = k * PERIOD, np.exp(-k / (1 + count / 8))
        truth = goal + nearness * _configuration(rng, joints)
        truth[3:7] /= np.linalg.norm(truth[3:7])
        blocks = {
            "true_configuration": truth,
            "momentum_residual": rng.normal(size=2) * 1e-12,
            "applied_wrench": rng.normal(size=6),
            "energy_residual": float(rng.normal()) * 1e-11,
            "applied_effort": rng.normal(size=joints),
            "saturation": (rng.random(6 + joints) < 0.02).astype(float),
            "quaternion_residual": float(rng.normal()) * 1e-12,
            "joint_limit": float(rng.random()),
        }
        asked = goal if settles else _configuration(rng, joints)
        rate = np.zeros(6 + joints) if settles else rng.normal(size=6 + joints)
        state = RobotState(stamp, truth, rng.normal(size=6 + joints), rng.normal(size=joints), rng.normal(size=3))
        output = ControlOutput(Command(stamp, rng.normal(size=6), rng.normal(size=joints)), Telemetry.of(stamp, {}))
        ticks.append(Tick(PlantSample(state, Telemetry.of(stamp, blocks)), Reference(stamp, asked, rate, rate), output))
    return ticks


def _configuration(rng: np.random.Generator, joints: int) -> np.ndarray:
    attitude = rng.normal(size=4)
    return np.concatenate([rng.normal(size=3), attitude / np.linalg.norm(attitude), rng.normal(size=joints)])


@pytest.mark.parametrize("seed", range(12))
def test_metrics_have_the_bits_of_whole_arrays_however_a_run_is_cut(
    seed: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """For random logs every metric from blocks of any size equals the one from whole arrays, bit for bit."""
    rng = np.random.default_rng(seed)
    joints, count = int(rng.integers(1, 10)), int(rng.choice([1, 2, 9, 140, 300]))
    names = [f"joint{index + 1}" for index in range(joints)]
    ticks = random_ticks(rng, count, joints, settles=bool(seed % 3))
    options = {
        "base_translation": bool(seed % 2),
        "prismatic": [bool(rng.integers(2)) for _ in names],
        "bands": {names[0]: 0.3, "base/yaw": 5.0} if seed % 4 else None,
    }
    expected = measure_whole(ticks, names, **options)
    sink = LogSink(tmp_path / "run", LogHeader("", _urdf(names), 0, tuple(names)))
    for tick in ticks:
        sink.record(tick)
    sink.close("completed")
    for size in (1, int(rng.integers(2, 100)), 1024):
        measurement = Measurement(names, **options)
        for block in LogReader(tmp_path / "run").blocks(size):
            measurement.add(*log_block(block))
        _assert_same(measurement.result(), expected)
        monkeypatch.setattr(measuring, "BLOCK", size)
        _assert_same(measure(iter(ticks), names, **options), expected)


def _assert_same(found, expected) -> None:
    for name, value in expected.flat().items():
        assert found.flat()[name] == value, name
    assert [(axis.name, axis.unit, axis.travel) for axis in found.axes] == [
        (axis.name, axis.unit, axis.travel) for axis in expected.axes
    ]
    assert (found.ticks, found.simulated_time) == (expected.ticks, expected.simulated_time)


def _urdf(names: list[str]) -> str:
    links = ["base_link", *(f"link{index + 1}" for index in range(len(names)))]
    joints = [
        f'<joint name="{name}" type="revolute"><axis xyz="0 0 1"/><parent link="{links[index]}"/>'
        f'<child link="{links[index + 1]}"/></joint>'
        for index, name in enumerate(names)
    ]
    return f"<robot name='chain'>{''.join(f'<link name={link!r}/>' for link in links)}{''.join(joints)}</robot>"
