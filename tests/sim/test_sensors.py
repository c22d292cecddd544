"""Sensors: statistics, independence, delay, quantisation."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from pydantic import ValidationError

from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import RobotState
from space_robot_sim.sensors import Sensors
from space_robot_sim.spec import SensorSpec
from tests.support.values import bits

PERIOD = 100_000_000
JOINTS = 3
CHANNELS = tuple(SensorSpec.model_fields)


def sensors(seed: int = 1, **channels: Any) -> Sensors:
    return Sensors(SensorSpec.model_validate({"wheel_momentum": {}} | channels), JOINTS, PERIOD, seed)


def truth(k: int = 0) -> RobotState:
    rng = np.random.default_rng(100 + k)
    attitude = rng.normal(size=4)
    q = np.concatenate([rng.normal(size=3), attitude / np.linalg.norm(attitude), rng.normal(size=JOINTS)])
    return RobotState(k * PERIOD, q, *(rng.normal(size=size) for size in (6 + JOINTS, JOINTS, 3, 3)))


def parts(state: RobotState) -> dict[str, np.ndarray]:
    assert state.wheel_momentum is not None
    return {
        "position": state.q[:3],
        "attitude": state.q[3:7],
        "linear_velocity": state.v[:3],
        "angular_velocity": state.v[3:6],
        "joint_position": state.q[7:],
        "joint_velocity": state.v[6:],
        "acceleration": state.base_acceleration,
        "wheel_momentum": state.wheel_momentum,
    }


def turn_between(measured: np.ndarray, true: np.ndarray) -> np.ndarray:
    """Rotation vector from the true to the measured body frame."""
    both = [pin.Quaternion(np.array(q)) for q in (true, measured)]
    return pin.log3((both[0].conjugate() * both[1]).matrix())


def test_ideal_sensors_pass_the_truth() -> None:
    """Without noise the very bits of the truth come through, also beside a noisy channel."""
    state = truth()
    assert sensors().measure(state) is state
    read = parts(sensors(position={"noise": 0.1}).measure(state))
    assert read.pop("position").tobytes() != state.q[:3].tobytes()
    assert all(part.tobytes() == parts(state)[name].tobytes() for name, part in read.items())


@pytest.mark.parametrize("name", CHANNELS)
def test_noise_and_bias_have_their_statistics(name: str) -> None:
    """The error of each channel has the mean and the standard deviation that were asked for."""
    suite, state = sensors(**{name: {"noise": 0.02, "bias": 0.05}}), truth()
    true = parts(state)[name]
    read = [parts(suite.measure(state))[name] for _ in range(3000)]
    errors = np.array([turn_between(r, true) if name == "attitude" else r - true for r in read])
    # Five standard errors of the mean and of the deviation.
    np.testing.assert_allclose(errors.mean(axis=0), 0.05, atol=5 * 0.02 / np.sqrt(3000))
    np.testing.assert_allclose(errors.std(axis=0), 0.02, atol=5 * 0.02 / np.sqrt(2 * 3000))
    assert abs(np.corrcoef(errors[:-1, 0], errors[1:, 0])[0, 1]) < 0.1


def test_attitude_stays_unit_and_on_its_side() -> None:
    """Measured quaternions are unit and never jump to the other sign."""
    suite = sensors(attitude={"noise": 0.3, "quantisation": 0.01})
    for k in range(200):
        state = truth(k)
        measured = suite.measure(state).q[3:7]
        assert np.linalg.norm(measured) == pytest.approx(1.0, abs=1e-14)
        assert measured @ state.q[3:7] >= 0.0


@pytest.mark.parametrize("name", CHANNELS)
def test_channels_are_independent(name: str) -> None:
    """Switching a channel on leaves the numbers of every other noisy channel as they were."""
    others = {other: {"noise": 0.1} for other in CHANNELS if other != name}
    without, with_it = sensors(**others), sensors(**others, **{name: {"noise": 0.2}})
    for k in range(3):
        first, second = parts(without.measure(truth(k))), parts(with_it.measure(truth(k)))
        assert first.pop(name).tobytes() != second.pop(name).tobytes()
        assert all(first[other].tobytes() == second[other].tobytes() for other in first)


def test_wheels_that_are_not_measured_change_no_other_number() -> None:
    """The channel of the wheels has the last generator: without it all others draw what they draw with it."""
    noisy = {other: {"noise": 0.1} for other in CHANNELS if other != "wheel_momentum"}
    without, with_it = sensors(wheel_momentum=None, **noisy), sensors(wheel_momentum={"noise": 0.1}, **noisy)
    for k in range(3):
        first, second = without.measure(replace(truth(k), wheel_momentum=None)), with_it.measure(truth(k))
        assert first.wheel_momentum is None
        assert bits(first)[1][:-1] == bits(second)[1][:-1]


def test_seed_decides_and_reset_repeats() -> None:
    """Equal seeds give equal bits, other seeds others, and reset starts the same sequence anew."""
    options: dict[str, Any] = {"joint_position": {"noise": 0.1}, "acceleration": {"noise": 0.1, "delay": 0.2}}
    suite, same, other = sensors(5, **options), sensors(5, **options), sensors(6, **options)
    first = [suite.measure(truth(k)).q.tobytes() for k in range(4)]
    assert first == [same.measure(truth(k)).q.tobytes() for k in range(4)]
    assert first != [other.measure(truth(k)).q.tobytes() for k in range(4)]
    suite.reset()
    assert first == [suite.measure(truth(k)).q.tobytes() for k in range(4)]


@pytest.mark.parametrize("name", CHANNELS)
def test_delay_shows_older_truth(name: str) -> None:
    """A delayed channel shows the truth of that many periods ago, before that the first one; all others the present."""
    suite = sensors(**{name: {"delay": 0.2}})
    for _ in range(2):
        for k, age in enumerate((0, 1, 2, 2, 2)):
            for part, shown in parts(suite.measure(truth(k))).items():
                np.testing.assert_allclose(shown, parts(truth(k - age if part == name else k))[part], atol=1e-15)
        suite.reset()


def test_quantised_readings_are_multiples() -> None:
    """A quantised reading is the nearest multiple of the quantum, per component."""
    suite, state = sensors(joint_position={"quantisation": [0.1, 0.0, 0.25]}), truth()
    read = suite.measure(state).q[7:]
    assert read[0] == pytest.approx(0.1 * round(state.q[7] / 0.1), abs=1e-15)
    assert read[1] == state.q[8]
    assert read[2] == 0.25 * round(state.q[9] / 0.25)


@pytest.mark.parametrize("name", [name for name in CHANNELS if name != "attitude"])
def test_every_channel_but_the_attitude_rounds_its_numbers(name: str) -> None:
    """To the nearest multiple of its quantum, after bias and noise."""
    suite, state = sensors(**{name: {"quantisation": 0.25, "bias": 0.125}}), truth(3)
    np.testing.assert_allclose(parts(suite.measure(state))[name], 0.25 * np.round((parts(state)[name] + 0.125) / 0.25))


def test_bad_channels_are_refused() -> None:
    """A delay off the grid, a vector of the wrong length and a negative deviation are errors by name."""
    with pytest.raises(SpecError, match=r"plant.sensors.position.delay: .*got 0.15; accepted: multiples of 0.1 s"):
        sensors(position={"delay": 0.15})
    with pytest.raises(SpecError, match=r"plant.sensors.joint_velocity.bias: wrong number"):
        sensors(joint_velocity={"bias": [1.0, 2.0]})
    sensors(wheel_momentum={"delay": 1000.0})
    for name in CHANNELS:
        said = rf"plant\.sensors\.{name}\.delay: too old a reading; got 1000\.1; accepted: at most 10000 .*, 1000 s"
        with pytest.raises(SpecError, match=said):
            sensors(**{name: {"delay": 1000.1}})
    with pytest.raises(SpecError, match=r"wheel_momentum\.noise: wrong number of values; got 2; .* one number, or 3"):
        sensors(wheel_momentum={"noise": [1.0, 2.0]})
    with pytest.raises(ValidationError, match="must not be negative"):
        sensors(position={"noise": -1.0})
    with pytest.raises(ValidationError, match="Extra inputs"):
        sensors(gyro={"noise": 1.0})
