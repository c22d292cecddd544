"""Faults of sensors: what is reported, beside a truth that they do not change."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
import pytest

from space_robot_description.rotations import exp, from_rpy, log, matrix, relative
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import PlantSample, Vector
from space_robot_sim.spec import ChannelSpec, SensorSpec
from tests.sim.faults.support import WHEELS, block, fault, simulated

ONSET, END = 10, 25
WINDOW = {"for": 1.5}
CHANNELS = tuple(SensorSpec.model_fields)
# A robot with wheels whose momentum is measured: every channel is there.
MEASURED = SensorSpec(wheel_momentum=ChannelSpec())
run = partial(simulated, actuators=WHEELS, sensors=MEASURED)
TRUE = run([])


def channel(samples: Sequence[PlantSample], name: str) -> Vector:
    """(K, size) what a channel reports."""
    places: dict[str, Any] = {
        "position": lambda s: s.q[:3],
        "attitude": lambda s: s.q[3:7],
        "joint_position": lambda s: s.q[7:],
        "linear_velocity": lambda s: s.v[:3],
        "angular_velocity": lambda s: s.v[3:6],
        "joint_velocity": lambda s: s.v[6:],
        "acceleration": lambda s: s.base_acceleration,
        "wheel_momentum": lambda s: s.wheel_momentum,
    }
    return np.array([places[name](sample.state) for sample in samples])


def reported(kind: str, name: str, sensors: SensorSpec = MEASURED, **keys: Any) -> Vector:
    """What the channel of a fault reports; the truth and all other channels are as without it."""
    samples = run([fault(kind, channel=name, **WINDOW, **keys)], sensors=sensors)
    without = TRUE if sensors is MEASURED else run([], sensors=sensors)
    assert block(samples, "true_configuration").tobytes() == block(TRUE, "true_configuration").tobytes()
    for other in CHANNELS:
        same = channel(samples, other)[:ONSET] if other == name else channel(samples, other)
        assert same.tobytes() == channel(without, other)[: len(same)].tobytes()
    healed = END + (10 if kind == "sensor_delay" else 0)
    assert channel(samples, name)[healed:].tobytes() == channel(without, name)[healed:].tobytes()
    return channel(samples, name)


def errors(found: Vector, name: str) -> Vector:
    """(K, size) difference to the truth within the window; of attitudes small rotations of the body."""
    true = channel(TRUE, name)
    if name != "attitude":
        return np.array(found - true)[ONSET:END]
    return np.array([log(relative(a, b)) for a, b in zip(true, found, strict=True)])[ONSET:END]


@pytest.mark.parametrize("name", CHANNELS)
def test_a_bias_is_a_constant(name: str) -> None:
    """The reading is off by the bias throughout the window."""
    found = errors(reported("sensor_bias", name, bias=0.02), name)
    np.testing.assert_allclose(found, 0.02, rtol=1e-9)


@pytest.mark.parametrize("name", CHANNELS)
def test_a_drift_grows_with_time(name: str) -> None:
    """The reading is off by the rate times the time since the onset."""
    found = errors(reported("sensor_drift", name, rate=0.03), name)
    expected = 0.03 * 0.1 * np.arange(END - ONSET)[:, None] * np.ones(found.shape[1])
    np.testing.assert_allclose(found, expected, atol=1e-12)


@pytest.mark.parametrize("name", CHANNELS)
def test_a_frozen_channel_repeats_its_last_reading(name: str) -> None:
    """The measurement is constant while the truth moves: what was reported before the onset."""
    found, true = reported("sensor_frozen", name), channel(TRUE, name)
    assert {row.tobytes() for row in found[ONSET:END]} == {true[ONSET - 1].tobytes()}
    assert len({row.tobytes() for row in true[ONSET:END]}) == END - ONSET


@pytest.mark.parametrize("name", CHANNELS)
def test_a_delay_shows_what_was(name: str) -> None:
    """The reading is that of three periods ago, from the onset on."""
    found, true = reported("sensor_delay", name, delay=0.3), channel(TRUE, name)
    assert found[ONSET:END].tobytes() == true[ONSET - 3 : END - 3].tobytes()


@pytest.mark.parametrize("name", CHANNELS)
def test_noise_has_the_size_that_was_asked_for(name: str) -> None:
    """Alone it has its sigma; as a multiple of the channel's own noise the whole has that multiple."""
    one = errors(reported("sensor_noise", name, sigma=1e-3), name)
    assert np.std(one) == pytest.approx(1e-3, rel=0.35)
    assert abs(one.mean()) < 0.5e-3
    own = SensorSpec.model_validate({"wheel_momentum": {}} | {name: {"noise": 1e-4}})
    several = errors(reported("sensor_noise", name, sensors=own, factor=5.0), name)
    assert np.std(several) == pytest.approx(5e-4, rel=0.35)


def test_noise_depends_on_seed_and_tick_alone() -> None:
    """Equal seeds give equal bits, other seeds others, and a fault before it in the list changes no draw of its."""
    noisy = fault("sensor_noise", channel="position", sigma=1e-3)
    first, again, other = (channel(run([noisy], seed=seed), "position") for seed in (5, 5, 6))
    assert first.tobytes() == again.tobytes()
    assert not np.any(first[ONSET:] == other[ONSET:])
    shorter = fault("sensor_noise", channel="position", sigma=1e-3, at=2.0)
    late = channel(run([shorter]), "position")
    assert late[20:].tobytes() == first[20:].tobytes()


@pytest.mark.parametrize("name", [name for name in CHANNELS if name != "attitude"])
def test_a_scale_multiplies(name: str) -> None:
    """The reading is factor times the truth."""
    found = reported("sensor_scale", name, factor=1.1)
    assert found[ONSET:END].tobytes() == (1.1 * channel(TRUE, name)[ONSET:END]).tobytes()


def test_a_scale_of_the_attitude_is_one_of_its_rotation_vector() -> None:
    """The axis stays, the angle is factor times the true one."""
    found, true = reported("sensor_scale", "attitude", factor=0.5), channel(TRUE, "attitude")
    for q, q_true in zip(found[ONSET:END], true[ONSET:END], strict=True):
        np.testing.assert_allclose(log(q), 0.5 * np.array(log(q_true)), atol=1e-12)


def test_outliers_have_their_length_and_come_as_often_as_said() -> None:
    """Each reading is the truth or wrong by a vector of that length."""
    samples = run([fault("sensor_outliers", channel="position", probability=0.3, length=2.0)], steps=200)
    distance = np.linalg.norm(channel(samples, "position") - block(samples, "true_configuration")[:, :3], axis=1)
    wrong = distance > 0.0
    np.testing.assert_allclose(distance[wrong], 2.0, rtol=1e-9)
    assert not wrong[:ONSET].any()
    assert 0.2 < wrong[ONSET:].mean() < 0.4


def test_a_flipped_quaternion_is_the_same_attitude() -> None:
    """Every number changes its sign, the rotation matrix stays."""
    found = reported("sensor_sign_flip", "attitude")
    assert found[ONSET:END].tobytes() == (-channel(TRUE, "attitude")[ONSET:END]).tobytes()
    sometimes = reported("sensor_sign_flip", "attitude", probability=0.5)[ONSET:END]
    signs = {float(np.sign(a @ b)) for a, b in zip(sometimes, channel(TRUE, "attitude")[ONSET:END], strict=True)}
    assert signs == {1.0, -1.0}


def test_a_wrong_frame_turns_readings_as_one_body() -> None:
    """A gyro turned by R reads R^T omega; a star tracker turned by R reports the attitude R(q) R."""
    turn = matrix(from_rpy(np.radians([0.0, 0.0, 90.0])))
    rates = reported("sensor_frame", "angular_velocity", rpy_deg=(0.0, 0.0, 90.0))[ONSET:END]
    np.testing.assert_allclose(rates, channel(TRUE, "angular_velocity")[ONSET:END] @ turn, atol=1e-15)
    attitudes = reported("sensor_frame", "attitude", rpy_deg=(0.0, 0.0, 90.0))[ONSET:END]
    for q, q_true in zip(attitudes, channel(TRUE, "attitude")[ONSET:END], strict=True):
        np.testing.assert_allclose(matrix(q), matrix(q_true) @ turn, atol=1e-12)


def test_faults_of_one_channel_add_up_in_their_order() -> None:
    """A bias behind a frozen reading is on it; a frozen reading behind a bias has that of before."""
    bias = fault("sensor_bias", channel="position", bias=1.0)
    frozen = fault("sensor_frozen", channel="position")
    before = channel(TRUE, "position")[ONSET - 1]
    first, second = (channel(run(faults), "position")[ONSET] for faults in ([frozen, bias], [bias, frozen]))
    np.testing.assert_array_equal(first, before + 1.0)
    np.testing.assert_array_equal(second, before)


def test_small_rotations_are_exp() -> None:
    """The error of an attitude is a rotation vector in the body frame."""
    found = reported("sensor_bias", "attitude", bias=(0.1, -0.2, 0.3))
    expected = matrix(channel(TRUE, "attitude")[ONSET]) @ matrix(exp((0.1, -0.2, 0.3)))
    np.testing.assert_allclose(matrix(found[ONSET]), expected, atol=1e-12)


def test_a_fault_of_a_channel_that_is_not_measured_is_refused() -> None:
    """Where no momentum of wheels is measured nothing can go wrong with it, whatever the kind of the fault."""
    for kind, keys in (("sensor_frozen", {}), ("sensor_noise", {"factor": 2.0}), ("sensor_bias", {"bias": 1.0})):
        with pytest.raises(SpecError, match=r"faults.0.channel: is not measured; got 'wheel_mom.*plant.sensors"):
            simulated([fault(kind, channel="wheel_momentum", **keys)], actuators=WHEELS)
