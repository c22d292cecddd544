"""The simulated robot: conservation, the conservation balance, delay and hold, errors, reproducibility."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from space_robot_msgs_py.errors import CommandError, IntegrationError, SpecError
from space_robot_msgs_py.interfaces import Command, PlantSample
from space_robot_sim.plant import InitialState, SimulatedRobot
from space_robot_sim.spec import IntegratorSpec, SensorSpec
from tests.support.robots import LivelyMotion, arm_model, random_state, robot_of
from tests.support.values import blocks_equal

PERIOD = 100_000_000


def plant_of(actuators: dict[str, Any] | None = None, *, floating: bool = False, **options: Any) -> SimulatedRobot:
    state = random_state(np.random.default_rng(0), 7, 0.05)
    robot = robot_of(arm_model(), actuators, floating=floating)
    return SimulatedRobot(robot, control_period=PERIOD, initial=InitialState(*state), **options)


def command(stamp: int = 0, scale: float = 1.0) -> Command:
    return Command(stamp, scale * np.arange(1.0, 7.0), scale * np.linspace(0.3, 0.01, 7))


def simulate(plant: SimulatedRobot, periods: int) -> list[PlantSample]:
    return [plant.reset(), *(plant.step(command(k, np.cos(0.3 * k))) for k in range(periods))]


WHEELS = {"base_torque": {"kind": "reaction_wheels", "torque": 2.0, "momentum": 50.0, "initial_momentum": (1, 2, -3)}}


@pytest.mark.parametrize(
    ("speed", "wheels", "step", "rates"),
    [(1.0, False, None, (1.0, 2.0)), (1.0, True, None, (1.0, 2.0)), (1.5, False, 0.025, (3.0, 5.0))],
)
def test_conserves_momentum_and_energy(
    speed: float, wheels: bool, step: float | None, rates: tuple[float, float]
) -> None:
    """A lively minute keeps momentum to 1e-10, energy to 1e-9: with the default step, and faster with half of it."""
    model = arm_model()
    motion = LivelyMotion(model, np.random.default_rng(6), speed)
    robot = robot_of(model, WHEELS if wheels else {}, floating=True)
    initial, spec = InitialState(*motion.start()), IntegratorSpec(step=step)
    plant = SimulatedRobot(robot, control_period=PERIOD, initial=initial, integrator=spec)
    sample, worst, fastest = plant.reset(), np.zeros(4), 0.0
    for k in range(600):
        torque = [np.cos(0.02 * k), np.sin(0.03 * k), 0.5] if wheels else [0.0] * 3
        effort = motion.effort(0.1 * k, sample.state.q, sample.state.v)
        sample = plant.step(Command(k * PERIOD, [0, 0, 0, *torque], effort))
        seen = [*sample.telemetry["momentum_residual"], *sample.telemetry["energy_residual"]]
        worst = np.maximum(worst, [*seen, *sample.telemetry["quaternion_residual"]])
        fastest = max(fastest, np.abs(sample.state.joint_rates).max())
    assert rates[0] < fastest < rates[1]
    assert np.all(worst < [1e-10, 1e-10, 1e-9, 1e-10]), worst


def test_momentum_and_energy_balance_under_external_forces() -> None:
    """With forces, torques, lag and friction, momentum changes by the impulse and energy by the work."""
    plant = plant_of({"joints": {"effort": 1e3, "lag": 0.05, "viscous": 0.3, "coulomb": 0.02}})
    last = simulate(plant, 100)[-1]
    assert last.telemetry["momentum_residual"].max() < 1e-9
    assert last.telemetry["energy_residual"].max() < 1e-9
    assert last.telemetry["energy"][0] > 1.0


def test_a_robot_at_rest_has_no_residuals() -> None:
    """Where nothing ever moves every residual is zero, not undefined."""
    robot = robot_of(arm_model())
    q = np.array([1.0, 2, 3, 0, 0, 0, 1, *np.linspace(-1, 1, 7)])
    plant = SimulatedRobot(robot, control_period=PERIOD, initial=InitialState(q, np.zeros(13)))
    sample = plant.step(None)
    for label in ("momentum_residual", "energy_residual", "quaternion_residual", "energy"):
        assert not sample.telemetry[label].any()
    assert sample.state.q.tobytes() == q.tobytes()


def test_telemetry_shows_the_truth() -> None:
    """Labels and sizes are fixed, and truth, momentum and energy are those of Pinocchio at the true state."""
    plant = plant_of(WHEELS, floating=True)
    samples = simulate(plant, 10)
    telemetry = samples[-1].telemetry
    assert dict(zip(telemetry.labels, telemetry.sizes, strict=True)) == {
        "true_configuration": 14,
        "true_velocity": 13,
        "momentum": 6,
        "energy": 1,
        "momentum_residual": 2,
        "energy_residual": 1,
        "quaternion_residual": 1,
        "wheel_momentum": 3,
        "applied_wrench": 6,
        "applied_effort": 7,
        "saturation": 13,
        "joint_limit": 7,
        "command_stamp": 1,
        "force_ignored": 1,
        "integration_error": 1,
    }
    assert {sample.telemetry.labels for sample in samples} == {telemetry.labels}
    model = arm_model()
    data, q, v = model.createData(), np.array(telemetry["true_configuration"]), np.array(telemetry["true_velocity"])
    pin.ccrba(model, data, q, v)
    np.testing.assert_allclose(telemetry["momentum"][:3], data.hg.linear, rtol=1e-12)
    assert telemetry["energy"][0] == pytest.approx(pin.computeKineticEnergy(model, data, q, v), rel=1e-12)
    assert samples[0].telemetry["force_ignored"][0] == 0.0
    assert telemetry["force_ignored"][0] == 1.0
    assert not telemetry["applied_wrench"][:3].any()
    assert set(plant_of().reset().telemetry.labels).isdisjoint({"wheel_momentum", "force_ignored"})


def test_base_acceleration_is_inertial() -> None:
    """The accelerometer reads d/dt of the inertial velocity of the base origin, in the body frame."""
    fine = 1_000_000
    state = InitialState(*random_state(np.random.default_rng(0), 7, 0.3))
    plant = SimulatedRobot(robot_of(arm_model()), control_period=fine, initial=state)
    before, middle, after = (plant.step(command()).state for _ in range(3))

    def velocity(s: Any) -> np.ndarray:
        return pin.Quaternion(np.array(s.q[3:7])).matrix() @ s.v[:3]

    inertial = (velocity(after) - velocity(before)) / 2e-3
    seen = pin.Quaternion(np.array(middle.q[3:7])).matrix() @ middle.base_acceleration
    np.testing.assert_allclose(seen, inertial, atol=1e-4 * np.abs(inertial).max())


def test_first_sample_has_the_acceleration_without_command() -> None:
    """The state at stamp 0 shows no effort and the acceleration of the robot left alone with its wheels' momentum."""
    sample = plant_of(WHEELS, floating=True).reset()
    q, v = random_state(np.random.default_rng(0), 7, 0.05)
    tau = np.zeros(13)
    tau[3:6] = -np.cross(v[3:6], [1.0, 2.0, -3.0])
    model = arm_model()
    expected = pin.aba(model, model.createData(), q, v, tau)[:3] + np.cross(v[3:6], v[:3])
    np.testing.assert_allclose(sample.state.base_acceleration, expected, rtol=1e-11)
    assert sample.state.stamp == 0
    assert not sample.state.effort.any()


def test_joint_limits_are_reported() -> None:
    """A joint outside its limits shows by how much, one inside shows zero."""
    lower, upper = np.full(7, -np.inf), np.full(7, np.inf)
    lower[1], upper[2] = -0.5, 0.25
    robot = robot_of(arm_model(), lower=lower, upper=upper)
    q = np.array([0, 0, 0, 0, 0, 0, 1, 0, -0.75, 0.5, 0, 0, 0, 0])
    outside = SimulatedRobot(robot, control_period=PERIOD, initial=InitialState(q, np.zeros(13))).reset()
    np.testing.assert_array_equal(outside.telemetry["joint_limit"], [0, 0.25, 0.25, 0, 0, 0, 0])


def test_delay_moves_every_command_by_one_period() -> None:
    """With a delay of one period nothing acts first, then everything acts one period later."""
    prompt, late = plant_of(), plant_of(delay_periods=1)
    commands = [command(k, scale) for k, scale in enumerate((1.0, -2.0, 0.5))]
    undelayed = [prompt.step(None), *(prompt.step(c) for c in commands[:2])]
    delayed = [late.step(c) for c in commands]
    for first, second in zip(undelayed, delayed, strict=True):
        assert blocks_equal([first.state.q, first.telemetry.data], [second.state.q, second.telemetry.data])


@pytest.mark.parametrize("hold", ["zero", "last"])
def test_a_missing_command_is_held(hold: str) -> None:
    """Without a command nothing acts, or the last one does; before any, nothing."""
    plant = plant_of(hold=hold)
    assert not plant.step(None).telemetry["applied_wrench"].any()
    given = plant.step(command()).telemetry["applied_wrench"]
    held = plant.step(None).telemetry["applied_wrench"]
    np.testing.assert_array_equal(held, given if hold == "last" else np.zeros(6))


@pytest.mark.parametrize("kernel", ["auto", "pinocchio"])
def test_same_inputs_same_bits(kernel: Any) -> None:
    """Two plants, and one plant after reset, give the same bits in every sample, noise and adaptive steps included."""
    options: dict[str, Any] = {
        "integrator": IntegratorSpec(kernel=kernel),
        "sensors": SensorSpec.model_validate({"position": {"noise": 0.01}, "attitude": {"noise": 0.01, "delay": 0.2}}),
        "seed": 7,
    }
    joints = {"joints": {"effort": 1e3, "lag": 0.05}}
    first, second = plant_of(joints, **options), plant_of(joints, **options)
    runs = [simulate(first, 6), simulate(second, 6), simulate(first, 6)]
    for others in runs[1:]:
        for a, b in zip(runs[0], others, strict=True):
            assert blocks_equal([a.state.q, a.state.v, a.telemetry.data], [b.state.q, b.state.v, b.telemetry.data])


@pytest.mark.parametrize("kernel", ["auto", "pinocchio"])
def test_the_end_of_finite_numbers_is_an_error(kernel: Any) -> None:
    """A state that stops being finite ends with the time and the quantity; a reset makes the plant whole again."""
    q, v = random_state(np.random.default_rng(0), 7)
    v[-1] = 1e150
    plant = SimulatedRobot(
        robot_of(arm_model()),
        control_period=PERIOD,
        initial=InitialState(q, v),
        integrator=IntegratorSpec(kernel=kernel),
    )
    for _ in range(2):
        assert plant.reset().state.stamp == 0
        with pytest.raises(IntegrationError, match=r"state\..*velocity: not finite between 0 s and 0.1 s"):
            plant.step(command())


def test_bad_arguments_are_refused() -> None:
    """Sizes, quaternion and period that do not fit are refused by name."""
    q, v = random_state(np.random.default_rng(0), 7)
    with pytest.raises(SpecError, match="quaternion is not unit"):
        InitialState(q * 2.0, v)
    with pytest.raises(CommandError, match=r"initial\.v"):
        InitialState(q, v[:-1])
    with pytest.raises(SpecError, match=r"initial\.q: wrong size; got 14; accepted: 13 numbers"):
        SimulatedRobot(robot_of(arm_model(6)), control_period=PERIOD, initial=InitialState(q, v))
    with pytest.raises(SpecError, match="control_period"):
        SimulatedRobot(robot_of(arm_model()), control_period=0, initial=InitialState(q, v))
    with pytest.raises(CommandError, match=r"command\.effort"):
        plant_of().step(Command(0, np.zeros(6), np.zeros(6)))
