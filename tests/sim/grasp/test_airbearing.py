"""The air-bearing testbed: its balance, its grasp, its cameras, its actuators, and what it refuses."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from space_robot_description.load import load_robot
from space_robot_description.robot import Robot
from space_robot_msgs_py.errors import CommandError, SpecError
from space_robot_msgs_py.interfaces import Command, PlantSample, Vector
from space_robot_sim.grasp.airbearing import AirbearingTestbed
from space_robot_sim.grasp.camera import Camera
from space_robot_sim.grasp.law import Grasp
from space_robot_sim.grasp.spec import AirbearingSpec, CameraSpec, GraspSpec
from space_robot_sim.initial import InitialState, RunConditions
from tests.support.values import blocks_equal

PERIOD = 100_000_000
CALM: dict[str, Any] = {
    "camera": {"position_noise": 0.0, "angle_noise_deg": 0.0, "outlier_share": 0.0, "delay": 0.0},
    "disturbance": {"force": 0.0, "torque": 0.0},
    "thruster_offset": 0.0,
}


def bench(robot: Robot | None = None, seed: int = 0, **spec: Any) -> AirbearingTestbed:
    q = np.array([0.3, -0.2, 0, 0, 0, np.sin(0.1), np.cos(0.1), 0, 0, 0])
    return AirbearingTestbed(
        robot or load_robot("airbearing"),
        AirbearingSpec.model_validate(spec),
        RunConditions(PERIOD, InitialState(q, np.zeros(9)), seed),
    )


def push(force: float = 0.0, torque: float = 0.0) -> Command:
    return Command(0, np.array([force, 0.0, 0.0, 0.0, 0.0, torque]), np.zeros(3))


def simulate(plant: AirbearingTestbed, commands: list[Command]) -> list[PlantSample]:
    return [plant.reset(), *(plant.step(command) for command in commands)]


def yaw(sample: PlantSample) -> float:
    q = sample.telemetry["true_configuration"]
    return float(2.0 * np.arctan2(q[5], q[6]))


def test_balance_closes_within_the_bounds_of_every_run() -> None:
    """Pushed, slipping and disturbed, the testbed balances momentum to 1e-9 and energy to 1e-8."""
    commands = [push(0.1 * np.sign(np.cos(0.05 * k)), 0.1 * np.sign(np.cos(0.07 * k))) for k in range(600)]
    samples = simulate(bench(), commands)
    for label, bound in (("momentum_residual", 1e-9), ("energy_residual", 1e-8), ("quaternion_residual", 1e-12)):
        assert max(sample.telemetry[label].max() for sample in samples) < bound
    assert max(abs(sample.telemetry["true_configuration"][9]) for sample in samples) > np.radians(1.5)


def test_a_held_second_body_moves_along() -> None:
    """Below the slip torque the pair gathers the momentum of 240 kg and turns as 160.6 kg m2 do."""
    along = simulate(bench(**CALM), [push(force=0.1)] * 300)[-1].telemetry
    np.testing.assert_allclose(np.linalg.norm(along["momentum"][:3]), 0.1 * 30.0, rtol=1e-9)
    turned = simulate(bench(**CALM, flywheel={"lag": 0.0}), [push(torque=0.05)] * 300)[-1].telemetry
    assert turned["wheel_momentum"][2] == pytest.approx(-1.5, rel=1e-9)
    assert np.abs(turned["momentum"][3:]).max() < 1e-12
    assert turned["true_velocity"][5] == pytest.approx(1.5 / 160.6, rel=0.1)


def test_testbed_motion_stays_in_the_plane() -> None:
    """Height, roll and pitch stay zero to the bit, also under commands that point out of the plane."""
    wild = Command(0, np.array([0.1, 0.1, 5.0, 3.0, -2.0, 0.1]), np.array([1.0, 2.0, 3.0]))
    samples = simulate(bench(), [wild] * 100)
    for sample in samples:
        q = sample.telemetry["true_configuration"]
        assert q[2:5].tolist() == [0.0, 0.0, 0.0]
    assert samples[-1].telemetry["command_ignored"][0] == 1.0
    assert simulate(bench(), [push(0.05, 0.05)])[-1].telemetry["command_ignored"][0] == 0.0


def test_the_grasp_slips_at_its_torque_and_keeps_the_angle() -> None:
    """The torsion never exceeds the slip torque plus its damping, and the configuration changes by some degrees."""
    samples = simulate(bench(), [push(torque=0.1)] * 60 + [push(torque=-0.1)] * 60 + [push()] * 300)
    torque = np.array([sample.telemetry["grasp_effort"][2] for sample in samples])
    rate = np.array([sample.telemetry["true_velocity"][8] for sample in samples])
    assert (np.abs(torque) <= 0.042 + 2.0 * np.abs(rate) + 1e-9).all()
    angle = np.degrees([sample.telemetry["true_configuration"][9] for sample in samples])
    assert 1.0 < np.abs(angle).max() < 6.0
    assert np.ptp(angle[-50:]) < 0.1
    assert np.abs(angle[-50:]).min() > 0.1
    assert max(np.abs(sample.telemetry["true_configuration"][7:9]).max() for sample in samples) < 0.004


def test_a_small_push_is_held_elastically() -> None:
    """Far below the slip torque the grasp springs back: the angle returns with the torque."""
    grasp, bristle = Grasp(GraspSpec()), 0.0
    for rate in [1e-3] * 100 + [-1e-3] * 100:
        bristle += 1e-2 * grasp.forces(0.0, 0.0, 0.0, 0.0, rate, bristle).bristle_rate
    assert abs(bristle) < 1e-4
    for _ in range(10_000):
        bristle += 1e-3 * grasp.forces(0.0, 0.0, 0.0, 0.0, 0.05, bristle).bristle_rate
    assert 4.0 * bristle == pytest.approx(0.042, rel=1e-3)


def test_grasp_work_is_stored_or_lost_never_made() -> None:
    """After every command has ended, kinetic plus elastic energy only falls."""
    samples = simulate(bench(**CALM), [push(0.1, 0.1)] * 50 + [push()] * 300)[60:]
    total = [float(sample.telemetry["energy"][0] + sample.telemetry["grasp_energy"][0]) for sample in samples]
    assert (np.diff(total) <= 1e-12).all()


def test_cameras_see_late_and_noisy_positions_only() -> None:
    """The reading is the truth of 0.1 s ago plus noise of the given size; velocities are its differences."""
    samples = simulate(bench(camera={"outlier_share": 0.0}), [push(0.1)] * 400)
    truth = np.array([sample.telemetry["true_configuration"][0] for sample in samples])
    seen = np.array([sample.state.q[0] for sample in samples])
    assert np.std(seen[1:] - truth[:-1]) == pytest.approx(3e-4, rel=0.15)
    state, before = samples[-1].state, samples[-2].state
    change = (state.q[:2] - before.q[:2]) / 0.1
    angle = 2.0 * np.arctan2(state.q[5], state.q[6])
    expected = np.cos(angle) * change[0] + np.sin(angle) * change[1]
    assert state.v[0] == pytest.approx(expected, rel=1e-9)
    assert not state.effort.any()


def test_distortions_come_as_often_as_asked_and_do_not_shift_each_other() -> None:
    """The share of outliers is that of the file, and more dropouts leave the noise where it is."""

    def readings(**spec: float) -> Vector:
        camera = Camera(CameraSpec.model_validate(spec), np.array([True, True, False]), PERIOD, 3)
        q = np.array([1.0, 0, 0, 0, 0, 0, 1.0, 0, 0, 0])
        return np.array([camera.measure(k * PERIOD, q).q[0] for k in range(4000)])

    clean, struck, dropped = readings(outlier_share=0.0), readings(outlier_share=0.05), readings(dropout_share=0.1)
    wrong = np.abs(struck - clean) > 1e-12
    assert wrong.mean() == pytest.approx(0.05, abs=0.012)
    kept = np.abs(readings(outlier_share=0.005) - dropped) < 1e-12
    assert 0.85 < kept.mean() < 0.95


def test_a_testbed_run_is_a_function_of_its_seed() -> None:
    """The same seed gives the same bits, another seed another disturbance and other noise."""
    commands = [push(0.05, 0.02)] * 20
    first, again, other = (simulate(bench(seed=seed), commands)[-1] for seed in (4, 4, 5))
    assert blocks_equal((first.state.q, first.telemetry.data), (again.state.q, again.telemetry.data))
    assert not blocks_equal((first.telemetry.data,), (other.telemetry.data,))


def test_the_flywheel_lags_saturates_and_fills() -> None:
    """The torque follows with its lag, a command beyond the limit is flagged, a full wheel takes no more."""
    samples = simulate(bench(**CALM), [push(torque=0.3)] * 600)
    assert 0.0 < samples[1].telemetry["applied_wrench"][5] < 0.05
    assert samples[20].telemetry["applied_wrench"][5] == pytest.approx(0.1, rel=1e-3)
    assert samples[20].telemetry["saturation"].tolist() == [0, 0, 0, 0, 0, 1, 0, 0, 0]
    assert abs(samples[-1].telemetry["wheel_momentum"][2]) == pytest.approx(5.0, abs=0.05)
    assert abs(samples[-1].telemetry["applied_wrench"][5]) < 1e-3


def test_a_bad_testbed_configuration_is_refused() -> None:
    """Another robot, an initial state off the table, a period that does not divide, a command for other joints."""
    with pytest.raises(SpecError, match="does not lie on the table"):
        bench(load_robot("servicer"))
    with pytest.raises(SpecError, match=r"plant\.grasp\.joints"):
        bench(grasp={"joints": ["grasp_x", "grasp_y", "grasp"]})
    with pytest.raises(SpecError, match="wrong kind"):
        bench(grasp={"joints": ["grasp_angle", "grasp_y", "grasp_x"]})
    with pytest.raises(SpecError, match=r"plant\.camera\.delay"):
        bench(camera={"delay": 0.07})
    with pytest.raises(SpecError, match="leaves the table"):
        AirbearingTestbed(
            load_robot("airbearing"),
            AirbearingSpec(),
            RunConditions(PERIOD, InitialState(np.array([0, 0, 1.0, 0, 0, 0, 1, 0, 0, 0]), np.zeros(9))),
        )
    with pytest.raises(CommandError, match="effort"):
        bench().step(Command(0, np.zeros(6), np.zeros(2)))
