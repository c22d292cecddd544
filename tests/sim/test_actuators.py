"""Motors, wheels and thrusters: what becomes of a command."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from hypothesis import strategies as st

from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Command, PlantSample
from space_robot_sim.actuators import capability
from space_robot_sim.kernel.allocation import allocate, allocation
from space_robot_sim.plant import InitialState, SimulatedRobot
from tests.support.robots import Vector, arm_model, random_model, random_state, robot_of

PERIOD = 100_000_000
REST = np.array([0.0, 0, 0, 0, 0, 0, 1])


def body_plant(actuators: dict[str, Any], *, floating: bool = False, omega: Any = (0.0, 0.0, 0.0)) -> SimulatedRobot:
    """One rigid body of 10 kg with inertia diag(2, 3, 4)."""
    model = random_model(np.random.default_rng(0), 0)
    model.inertias[1] = pin.Inertia(10.0, np.zeros(3), np.diag([2.0, 3.0, 4.0]))
    initial = InitialState(REST, np.array([0.0, 0, 0, *omega]))
    return SimulatedRobot(robot_of(model, actuators, floating=floating), control_period=PERIOD, initial=initial)


def coaxial_plant(joints: dict[str, Any], rate: float = 0.0) -> SimulatedRobot:
    """A base of 2 kg m2 and a rotor of 0.5 kg m2 on one axis: the joint sees 1 / (1/2 + 1/0.5) = 0.4 kg m2."""
    model = pin.Model()
    model.gravity.setZero()
    base = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root")
    model.appendBodyToJoint(base, pin.Inertia(10.0, np.zeros(3), np.diag([2.0, 2.0, 2.0])), pin.SE3.Identity())
    rotor = model.addJoint(base, pin.JointModelRZ(), pin.SE3.Identity(), "rotor")
    model.appendBodyToJoint(rotor, pin.Inertia(1.0, np.zeros(3), np.diag([0.5, 0.5, 0.5])), pin.SE3.Identity())
    initial = InitialState(np.append(REST, 0.0), np.array([0.0, 0, 0, 0, 0, 0, rate]))
    return SimulatedRobot(robot_of(model, {"joints": joints}), control_period=PERIOD, initial=initial)


def push(plant: SimulatedRobot, wrench: Any = (0.0,) * 6, effort: Any = (), periods: int = 1) -> PlantSample:
    for k in range(periods):
        sample = plant.step(Command(k * PERIOD, wrench, effort))
    return sample


def wheels(torque: float = 1.0, momentum: float = 10.0, **more: Any) -> dict[str, Any]:
    return {"base_torque": {"kind": "reaction_wheels", "torque": torque, "momentum": momentum, **more}}


def test_motor_lag_is_a_first_order_step_response() -> None:
    """A lagging motor follows u (1 - exp(-t/lag)): effort, its mean and the joint rate are the closed forms."""
    lag, u, inertia = 0.08, 2.0, 0.4
    plant = coaxial_plant({"effort": 10.0, "lag": lag})
    for k in range(1, 6):
        sample = push(plant, effort=[u])
        t, before = 0.1 * k, 0.1 * (k - 1)
        impulse = u * (t - lag * -np.expm1(-t / lag))
        earlier = u * (before - lag * -np.expm1(-before / lag))
        assert sample.state.joint_rates[0] == pytest.approx(impulse / inertia, rel=1e-9)
        assert sample.state.effort[0] == pytest.approx((impulse - earlier) / 0.1, rel=1e-12)
        assert sample.telemetry["applied_effort"][0] == sample.state.effort[0]


def test_viscous_friction_decays_exponentially() -> None:
    """A coasting joint with viscous friction slows as exp(-c t / I), and the lost energy is in the balance."""
    sample = push(coaxial_plant({"effort": 10.0, "viscous": 0.2}, rate=3.0), effort=[0.0], periods=20)
    assert sample.state.joint_rates[0] == pytest.approx(3.0 * np.exp(-0.2 * 2.0 / 0.4), rel=1e-9)
    assert sample.telemetry["energy_residual"][0] < 1e-9


def test_coulomb_friction_decelerates_evenly_and_stops() -> None:
    """Coulomb friction takes c/I from the rate every second, then holds the joint still."""
    plant = coaxial_plant({"effort": 10.0, "coulomb": 0.4, "coulomb_velocity": 1e-3}, rate=1.0)
    moving = push(plant, effort=[0.0], periods=5)
    assert moving.state.joint_rates[0] == pytest.approx(0.5, abs=1e-9)
    stopped = push(plant, effort=[0.0], periods=6)
    assert abs(stopped.state.joint_rates[0]) < 1e-9
    assert stopped.telemetry["energy_residual"][0] < 1e-9


def test_wheels_spin_the_body_up() -> None:
    """Wheels give a body at rest the momentum they take: omega = tau t / I, and the total stays zero."""
    sample = push(body_plant(wheels(), floating=True), wrench=[0, 0, 0, 0, 0, 0.5], periods=10)
    assert sample.state.v[5] == pytest.approx(0.5 * 1.0 / 4.0, rel=1e-12)
    np.testing.assert_allclose(sample.telemetry["wheel_momentum"], [0, 0, -0.5], atol=1e-15)
    assert np.abs(sample.telemetry["momentum"]).max() < 1e-14


def test_wheels_keep_total_momentum_through_saturation() -> None:
    """Skewed wheels on a tumbling robot run full within a period; the total angular momentum never changes."""
    axes = [[1, 0, 0.3], [0, 1, 0.3], [-1, 0.2, 0.6], [0.1, -1, 0.4]]
    joints = 7
    robot = robot_of(arm_model(), wheels(3.0, 2.0, axes=axes, initial_momentum=[0.5, -1.0, 1.5, 0.0]), floating=True)
    state = random_state(np.random.default_rng(3), joints, 0.05)
    plant = SimulatedRobot(robot, control_period=PERIOD, initial=InitialState(*state))
    start, full = plant.reset().telemetry["momentum"], np.zeros(4, dtype=bool)
    for k in range(40):
        wrench = [0, 0, 0, 3 * np.cos(0.3 * k), -3, 2 * np.sin(0.2 * k)]
        sample = push(plant, wrench, 0.1 * np.cos(0.5 * k) * np.geomspace(1.0, 0.02, joints))
        telemetry = sample.telemetry
        np.testing.assert_allclose(telemetry["momentum"], start, rtol=0, atol=1e-10 * np.abs(start).max())
        assert telemetry["energy_residual"][0] < 1e-9
        full |= np.abs(telemetry["wheel_momentum"]) == 2.0
    assert np.abs(telemetry["wheel_momentum"]).max() <= 2.0
    assert full.sum() >= 2


def test_a_full_wheel_gives_torque_only_away_from_its_limit() -> None:
    """A wheel that reaches its limit stops at that instant; the other direction still works."""
    plant = body_plant(wheels(1.0, 0.25, initial_momentum=[0.0, 0.0, 0.2]), floating=True)
    filling = push(plant, wrench=[0, 0, 0, 0, 0, -1.0])
    assert filling.telemetry["wheel_momentum"][2] == 0.25
    # 0.05 N m s were left: half of the period.
    assert filling.telemetry["applied_wrench"][5] == pytest.approx(-0.5, rel=1e-12)
    assert filling.telemetry["saturation"].tolist() == [0, 0, 0, 0, 0, 1]
    stuck = push(plant, wrench=[0, 0, 0, 0, 0, -1.0])
    assert stuck.telemetry["applied_wrench"][5] == 0.0
    assert stuck.telemetry["saturation"][5] == 1.0
    back = push(plant, wrench=[0, 0, 0, 0, 0, 1.0])
    assert back.telemetry["applied_wrench"][5] == pytest.approx(1.0, rel=1e-12)
    assert back.telemetry["saturation"][5] == 0.0


def test_spinning_wheel_precesses_the_body() -> None:
    """Stored momentum pushes a turning body sideways by -omega x h and does no work."""
    plant = body_plant(wheels(1.0, 100.0, initial_momentum=[0.0, 0.0, 5.0]), floating=True, omega=(0.1, 0.0, 0.0))
    start = plant.reset()
    later = push(plant, periods=3)
    energies = [sample.telemetry["energy"][0] for sample in (start, later)]
    assert energies[0] == pytest.approx(energies[1], rel=1e-12)
    # Small rates: Ix wx' = -h wy, Iy wy' = h wx.
    nutation = 5.0 / np.sqrt(2.0 * 3.0)
    assert later.state.v[3] == pytest.approx(0.1 * np.cos(nutation * 0.3), rel=1e-3)
    assert later.state.v[4] == pytest.approx(0.1 * np.sqrt(2.0 / 3.0) * np.sin(nutation * 0.3), rel=1e-3)


@pytest.mark.parametrize("pwm", [False, True])
def test_thruster_impulse_is_the_commanded_one(pwm: bool) -> None:
    """Above the minimum pulse the impulse over a period is that of the command, pulsed or not."""
    thrusters = {"kind": "thrusters", "limit": [20.0, 10.0, 5.0], "pwm": pwm, "minimum_pulse": 0.01 if pwm else 0.0}
    plant = body_plant({"base_force": thrusters})
    asked = np.array([5.0, -7.0, 2.5])
    sample = push(plant, wrench=[*asked, 0, 0, 0])
    np.testing.assert_allclose(sample.state.v[:3], asked * 0.1 / 10.0, rtol=1e-12)
    np.testing.assert_allclose(sample.telemetry["applied_wrench"][:3], asked, rtol=1e-12)
    assert not sample.telemetry["saturation"].any()
    # Level thrust: half of a t^2; a pulse comes first, so the body is further on.
    level = asked / 10.0 * 0.005
    assert np.all(np.abs(sample.state.q[:3]) > np.abs(level) * 1.2) if pwm else np.allclose(sample.state.q[:3], level)


def test_short_pulses_are_not_fired() -> None:
    """A pulse below the minimum does nothing, one just above it fires."""
    pulsed = {"kind": "thrusters", "limit": [10.0] * 3, "pwm": True, "minimum_pulse": 0.02}
    plant = body_plant({"base_force": pulsed, "base_torque": pulsed})
    short = push(plant, wrench=[1.9, 0, 0, 0, -1.9, 0])
    assert not short.telemetry["applied_wrench"].any()
    assert not short.state.v.any()
    fired = push(plant, wrench=[2.1, 0, 0, 0, -2.1, 0])
    np.testing.assert_allclose(fired.telemetry["applied_wrench"], [2.1, 0, 0, 0, -2.1, 0], rtol=1e-12)


commands = st.lists(st.floats(-100.0, 100.0), min_size=13, max_size=13).map(np.array)


def applied(actuators: dict[str, Any], command: Vector, floating: bool = False) -> tuple[Vector, Vector]:
    """What a command becomes with wheels far from their limit: applied generalised force, saturation flags."""
    robot = robot_of(arm_model(), actuators, floating=floating)
    able = capability(robot, PERIOD)
    count = able.axes.shape[1]
    out = allocation(7, count)
    allocate(able, command, 0.1, np.zeros(count), out)
    return np.concatenate([out.wrench, out.effort]), out.saturated


LIMITS = np.array([30.0, 20.0, 10.0, 5.0, 6.0, 7.0, *([4.0] * 7)])
ACTUATORS: dict[str, Any] = {
    "joints": {"effort": 4.0},
    "base_force": {"kind": "thrusters", "limit": [30.0, 20.0, 10.0]},
    "base_torque": {"kind": "ideal", "limit": [5.0, 6.0, 7.0]},
}


@given(commands)
def test_per_axis_clips_every_channel(command: Vector) -> None:
    """Every channel is clipped to its own limit, and flagged where it was."""
    given_force, flags = applied(ACTUATORS, command)
    np.testing.assert_allclose(given_force, np.clip(command, -LIMITS, LIMITS), rtol=1e-12)
    np.testing.assert_array_equal(flags, np.abs(command) > LIMITS)


@given(commands)
def test_direction_preserving_keeps_the_direction(command: Vector) -> None:
    """The whole command is scaled by one number in [0, 1], 1 if it fits, with one channel at its limit if not."""
    given_force, flags = applied(ACTUATORS | {"saturation": "direction_preserving"}, command)
    scale = min(1.0, *(LIMITS / np.maximum(np.abs(command), 1e-300)))
    np.testing.assert_allclose(given_force, scale * command, rtol=1e-12, atol=1e-300)
    assert flags.any() == (scale < 1.0)


@given(commands)
def test_direction_preserving_includes_wheels(command: Vector) -> None:
    """The torque limit of a skewed wheel scales the whole command; a force that cannot act does not."""
    axes = [[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]]
    actuators = wheels(2.0, 1e9, axes=axes) | {"saturation": "direction_preserving", "joints": {"effort": 4.0}}
    given_force, _ = applied(actuators, command, floating=True)
    assert not given_force[:3].any()
    rest, asked = given_force[3:], command[3:]
    scale = rest @ asked / max(asked @ asked, 1e-300)
    assert 0.0 <= scale <= 1.0 + 1e-9
    np.testing.assert_allclose(rest, scale * asked, rtol=1e-9, atol=1e-9)


def test_minimum_pulse_longer_than_the_period_is_refused() -> None:
    """Thrusters that could never fire are refused with the period."""
    force = {"kind": "thrusters", "limit": [1.0] * 3, "pwm": True, "minimum_pulse": 0.2}
    with pytest.raises(
        SpecError, match=r"actuators.base_force.minimum_pulse: longer .* got 0.2; accepted: up to 0.1 s"
    ):
        body_plant({"base_force": force})
