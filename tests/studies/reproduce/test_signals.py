"""Signals by name are what the log holds, in the units people read."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from space_robot_bringup.compose.composition import Composition, compose
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.run import run_experiment
from space_robot_description.inertia import inertial_parameters
from space_robot_msgs_py.log.reader import LogReader
from space_robot_studies.reproduce.attitude_path import axis_distances, path_ratios
from space_robot_studies.reproduce.signals import PARAMETERS, Signals, signal_names, tool_errors
from tests.support.whole_metrics import measure

OVERRIDES = (
    "duration=5.0",
    "plant.sensors.attitude.noise=1.0e-3",
    "nominal.dispersion.eta=0.2",
)
ADAPTIVE = """
import numpy as np
from space_robot_control.laws import Law
from space_robot_description.inertia import inertial_parameters

class Adaptive(Law):
    def compute(self, state, reference):
        blocks = {"parameters": inertial_parameters(self.robot).ravel(), "pair": [3.0, -4.0]}
        return np.zeros(6 + self.n), blocks
"""


@pytest.fixture(scope="module")
def noisy_run(tmp_path_factory: pytest.TempPathFactory) -> tuple[Signals, Path]:
    """A short noisy run with another robot than the law believes in."""
    bag = tmp_path_factory.mktemp("signals") / "bag"
    experiment = load_experiment("liu2023/fig08", OVERRIDES)
    run_experiment(experiment, bag, mode="headless")
    return Signals(LogReader(bag).arrays(), compose(experiment)), bag


def test_every_name_gives_one_number_per_tick(noisy_run: tuple[Signals, Path]) -> None:
    """What is offered before a run is there after it, finite over the whole run; an axis only while it turns."""
    signals, _ = noisy_run
    names, law_labels = signal_names(signals.composition)
    assert law_labels
    assert len(set(names)) == len(names) > 100
    for name in names:
        values = signals.of(name)
        assert values.shape == signals.arrays.time.shape, name
        assert np.isfinite(values).all() or name == "base.axis_distance", name


def test_errors_are_those_of_the_metrics(noisy_run: tuple[Signals, Path]) -> None:
    """The largest, last and RMS error of a signal is the metric of that name: the true motion, not the measured one."""
    signals, bag = noisy_run
    numbers = measure(LogReader(bag).ticks(), signals.composition.joint_names, base_translation=False).flat()
    for axis in ("base/roll", "base/pitch", "base/yaw", *signals.composition.joint_names):
        error = signals.of(f"{axis}.error")
        assert np.abs(error).max() == pytest.approx(numbers[f"{axis}.max_error"], rel=1e-12, abs=1e-15)
        assert abs(error[-1]) == pytest.approx(numbers[f"{axis}.final_error"], rel=1e-12, abs=1e-15)
        assert np.sqrt(np.mean(error**2)) == pytest.approx(numbers[f"{axis}.rms_error"], rel=1e-12)


def test_joint_errors_are_value_minus_reference(noisy_run: tuple[Signals, Path]) -> None:
    """Of joints and of rotations about one axis the error is the difference of the curves one sees."""
    signals, _ = noisy_run
    for axis in (*signals.composition.joint_names, "base/x"):
        difference = signals.of(f"{axis}.value") - signals.of(f"{axis}.reference")
        assert np.allclose(signals.of(f"{axis}.error"), difference, atol=1e-12)
    assert signals.of("base/roll.reference")[1] == pytest.approx(10.0)
    assert signals.of("base/roll.error")[0] == pytest.approx(-10.0)


def test_rates_are_the_derivatives_of_the_values(tmp_path: Path) -> None:
    """Of positions and of a turn about one axis, of joints and of slides: the curve is the integral of its rate."""
    experiment = load_experiment("song2023/position_874_pd", ["initial.attitude_deg=[0, 0, 40]", "duration=10.0"])
    run_experiment(experiment, tmp_path / "bag", mode="headless")
    signals = Signals(LogReader(tmp_path / "bag").arrays(), compose(experiment))
    time = signals.arrays.time
    for axis in ("base/x", "base/y", "base/yaw", "grasp_x", "grasp_angle"):
        value, rate = signals.of(f"{axis}.value"), signals.of(f"{axis}.rate")
        moved = np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(time))])
        assert np.abs(value - value[0]).max() > 0.0
        assert moved == pytest.approx(value - value[0], abs=0.02 * np.abs(value - value[0]).max()), axis


def test_lengths_of_joints_are_in_metres(tmp_path: Path) -> None:
    """A slide is shown as the plant holds it, and its metres are no part of the largest joint error in degrees."""
    experiment = load_experiment("song2023/attitude_6_85_pd", ["duration=3.0"])
    run_experiment(experiment, tmp_path / "bag", mode="headless")
    signals = Signals(LogReader(tmp_path / "bag").arrays(), compose(experiment))
    held = signals.arrays.plant["true_configuration"][:, 7:]
    assert np.array_equal(signals.of("grasp_x.value"), held[:, 0])
    assert np.array_equal(signals.of("grasp_y.error"), held[:, 1])
    assert np.array_equal(signals.of("grasp_angle.value"), held[:, 2] * np.degrees(1.0))
    assert np.array_equal(signals.of("joints.error"), np.abs(signals.of("grasp_angle.error")))


def test_totals_are_norms_and_elements_are_elements(noisy_run: tuple[Signals, Path]) -> None:
    """base.error is an angle, a block without index its norm, joints.error the largest."""
    signals, _ = noisy_run
    parts = np.array([signals.of(f"base/{axis}.error") for axis in ("roll", "pitch", "yaw")])
    assert np.allclose(signals.of("base.error"), np.linalg.norm(parts, axis=0))
    torque = np.array([signals.of(f"command.torque[{index}]") for index in range(3)])
    assert np.array_equal(torque.T, signals.arrays.wrench[:, 3:])
    assert np.allclose(signals.of("command.torque"), np.linalg.norm(torque, axis=0))
    joints = np.array([signals.of(f"{name}.error") for name in signals.composition.joint_names])
    assert np.array_equal(signals.of("joints.error"), np.abs(joints).max(axis=0))


def test_paths_and_tools_are_those_of_their_functions(noisy_run: tuple[Signals, Path]) -> None:
    """The path ends at its ratio, an axis has a distance while the base turns, the tool is that of the true robot."""
    signals, _ = noisy_run
    q, q_d = signals.arrays.plant["true_configuration"], signals.arrays.q_d
    assert signals.of("base.path")[-1] == path_ratios(q[:, 3:7], q_d[-1, 3:7])[-1]
    distances, turning = axis_distances(q[:, 3:7], signals.arrays.plant["true_velocity"][:, 3:6], q_d[-1, 3:7])
    shown = signals.of("base.axis_distance")
    assert np.array_equal(np.isfinite(shown), turning)
    assert np.array_equal(shown[turning], distances[turning])
    position, angle = tool_errors(signals.composition.truth, q, q_d)
    assert np.array_equal(signals.of("tool.position_error"), position)
    assert np.array_equal(signals.of("tool.attitude_error"), np.degrees(angle))
    half = np.radians(signals.of("base.error")) / 2.0
    assert np.allclose(signals.of("base.error_quaternion"), np.sin(half))


def test_without_a_way_to_go_there_is_no_path(tmp_path: Path) -> None:
    """A base that is to stay where it is has neither a geodesic nor an axis to compare."""
    experiment = load_experiment("liu2023/fig08", ["duration=1.0", "reference={kind: hold}"])
    run_experiment(experiment, tmp_path / "bag", mode="headless")
    signals = Signals(LogReader(tmp_path / "bag").arrays(), compose(experiment))
    assert np.isnan(signals.of("base.path")).all()
    assert np.isnan(signals.of("base.axis_distance")).all()


def test_parameters_are_of_the_robot_they_say(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Truth is the robot of the plant, prior what the law starts from, estimate what its telemetry says."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "adaptive.py").write_text(ADAPTIVE)
    law = "controller={law: 'adaptive.py:Adaptive'}"
    experiment = load_experiment(
        "liu2023/fig08", [law, "duration=0.5", "nominal.dispersion.eta=0.2", "plant.dispersion.eta=0.1"]
    )
    run_experiment(experiment, tmp_path / "bag", mode="headless")
    composition = compose(experiment)
    signals = Signals(LogReader(tmp_path / "bag").arrays(), composition)
    names, _ = signal_names(composition)
    robots = {"truth": composition.truth, "prior": composition.nominal, "estimate": composition.nominal}
    for kind, robot in robots.items():
        for row, body in enumerate(composition.nominal.body_names):
            for column, name in enumerate(PARAMETERS):
                assert f"{kind}/{body}/{name}" in names
                want = inertial_parameters(robot)[row, column]
                assert np.array_equal(signals.of(f"{kind}/{body}/{name}"), np.full(3, want))
    assert not np.array_equal(inertial_parameters(composition.truth), inertial_parameters(composition.nominal))
    assert np.array_equal(signals.of("controller.pair"), np.full(3, 5.0))
    assert np.array_equal(signals.of("controller.pair[1]"), np.full(3, -4.0))


def test_a_law_without_telemetry_has_no_labels(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where even the first state ends the run, names of the law's telemetry are unknown, and that is said."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "adaptive.py").write_text(ADAPTIVE.replace("6 + self.n", "6"))
    composition: Composition = compose(load_experiment("liu2023/fig08", ["controller={law: 'adaptive.py:Adaptive'}"]))
    names, law_labels = signal_names(composition)
    assert not law_labels
    assert not any(name.startswith("controller.") for name in names)
