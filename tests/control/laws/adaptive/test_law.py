"""The adaptive law: proven decrease, convergence, both readings of Lambda, the sampled rule, and how it fails."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest

from space_robot_bringup.compose.composition import Composition
from space_robot_control.laws import make_law
from space_robot_control.laws.adaptive.euler_coordinates import euler_state
from space_robot_control.laws.adaptive.regressor import Regressor
from space_robot_control.nominal_model import NominalModel
from space_robot_control.sampled_stability import stable_lambda
from space_robot_description.inertia import inertial_parameters
from space_robot_description.load import load_robot
from space_robot_description.rotations import from_rpy
from space_robot_msgs_py.errors import ControlError, SpecError
from space_robot_msgs_py.interfaces import Reference, RobotState, Tick, Vector
from tests.support.adaptive_runs import PRIOR, block, rms, simulate
from tests.support.values import bits


def lyapunov_function(composition: Composition, ticks: list[Tick], gamma: float) -> Vector:
    """(42) along a run with the true mass matrix and the true parameter error, which no law can know."""
    regressor, truth = Regressor(composition.truth), inertial_parameters(composition.truth).ravel()
    weight = 1.0 / (gamma * (np.abs(inertial_parameters(composition.nominal).ravel()) + 1e-3) ** 2)
    damping = Regressor(composition.nominal).reduced_mass_matrix(euler_state(ticks[0].sample.state)[0])
    values = []
    for tick in ticks:
        telemetry = tick.output.telemetry
        x, _ = euler_state(tick.sample.state)
        sigma = np.array([*telemetry["sliding_variable"][:3][::-1], *telemetry["sliding_variable"][3:]])
        error = np.array([*telemetry["euler_error"][::-1], *telemetry["joint_error"]])
        off = telemetry["parameters"] - truth
        kinetic = 0.5 * sigma @ regressor.reduced_mass_matrix(x) @ sigma
        values.append(kinetic + error @ damping @ error + 0.5 * weight @ off**2)
    return np.array(values)


def test_lyapunov_function_decreases_at_ten_milliseconds() -> None:
    """With the update (44), no noise and T = 10 ms, (42) falls at every period down to what the hold leaves."""
    gains = {"update": "lyapunov", "tracking": {"gain": 1000}, "lead": True}
    composition, ticks, reason = simulate(gains, control_period=0.01, duration=20.0, nominal=PRIOR)
    value = lyapunov_function(composition, ticks, 1000.0)
    assert reason == "completed"
    assert np.diff(value).max() < 1e-6 * value[0]
    assert value[-1] < 0.97 * value[0]


def test_half_a_period_of_lead_removes_the_error_of_the_hold() -> None:
    """With exact parameters at T = 0.25 s the lead leaves less than a fifth of the tracking error."""
    errors = [rms(simulate({"update": "none", "lead": lead})[1]) for lead in (False, True)]
    assert errors[1] < errors[0] / 5.0


@pytest.mark.parametrize("name", ["mini", "ur5_sat", "panda_sat", "servicer", "ets7"])
@pytest.mark.parametrize("update", ["rls", "lyapunov"])
def test_every_shipped_robot_is_tracked_with_a_wrong_prior(name: str, update: str) -> None:
    """Free-floating or free-flying, four to eight joints: 0.1 deg of tracking from a prior 10 % off."""
    reference = {"kind": "quintic", "duration": 30.0, "attitude_deg": [5, -5, 10], "joints_by_deg": 10}
    _, ticks, reason = simulate(
        {"update": update, "lead": True},
        robot=name,
        initial={},
        reference=reference,
        nominal={"dispersion": {"eta": 0.1, "inconsistent": "keep"}},
    )
    assert reason == "completed"
    assert np.degrees(rms(ticks)) < 0.1


def test_readings_of_lambda_have_the_poles_they_should() -> None:
    """Position: real poles, no overshoot. Velocity: s^2 + kappa (Lambda s + 1), which overshoots like that mode."""
    step = {"kind": "step", "attitude_deg": [1, 0, 0]}
    overshoot = {}
    for reading in ("position", "velocity"):
        gains = {"update": "none", "lambda": 0.8, "lambda_on": reading}
        _, ticks, _ = simulate(gains, reference=step, control_period=0.05, duration=30.0)
        roll = 1.0 - np.degrees(block(ticks, "euler_error")[:, 0])
        overshoot[reading] = roll.max() - 1.0
    damping = 0.4
    ideal = np.exp(-np.pi * damping / np.sqrt(1.0 - damping**2))
    assert overshoot["position"] < 1e-3
    assert overshoot["velocity"] == pytest.approx(ideal, abs=0.03)


def test_the_damping_may_be_given_once_for_every_prior() -> None:
    """K_D = kappa D: with D the matrix of the law itself the command is the same, with twice that another."""
    asked: dict[str, Any] = {"duration": 1.0, "reference": {"kind": "step", "attitude_deg": [1, 0, 0]}}
    composition, simulated, _ = simulate({"update": "none"}, **asked)
    own = Regressor(composition.nominal).reduced_mass_matrix(euler_state(simulated[0].sample.state)[0])
    own = 0.5 * (own + own.T)
    u = [
        simulate({"update": "none", "damping_inertia": matrix.tolist()}, **asked)[1][0].output.command.u
        for matrix in (own, 2.0 * own)
    ]
    np.testing.assert_allclose(u[0], simulated[0].output.command.u, rtol=1e-12, atol=1e-14)
    assert np.abs(u[1] - u[0]).max() > 1e-3


GRID = [
    (on, lead, period, decay)
    for on in ("position", "velocity")
    for lead in (False, True)
    for period in (0.1, 0.5, 1.0)
    for decay in (0.3, 1.0, 1.9)
]


@pytest.mark.parametrize(("on", "lead", "period", "decay"), GRID)
def test_the_sampled_rule_is_where_a_held_mode_begins_to_grow(on: Any, lead: bool, period: float, decay: float) -> None:
    """Inside the interval the held mode of rate d decays, just outside it grows, by the eigenvalues of one period."""
    low, high = stable_lambda(period, decay, on=on, lead=lead)

    def radius(weight: float) -> float:
        kp, kd = (decay * weight, decay + weight) if on == "position" else (decay, decay * weight)
        kd += 0.5 * period * kp if lead else 0.0
        t = period
        step = np.array([[1.0 - kp * t * t / 2.0, t - kd * t * t / 2.0], [-kp * t, 1.0 - kd * t]])
        return float(np.abs(np.linalg.eigvals(step)).max())

    assert low < high
    for inside in np.linspace(low, high, 7)[1:-1]:
        assert radius(inside) < 1.0
    assert radius(1.01 * high) > 1.0
    if low > 0.0:
        assert radius(0.99 * low) > 1.0


def test_review_states_the_rule_along_the_path_and_warns_outside() -> None:
    """Inside the rule there are facts and no warning, outside both; the run agrees."""
    step = {"kind": "step", "attitude_deg": [10, 0, 0], "joints_deg": [90, 55, 55, 10]}
    for weight, warned in ((2.0, False), (2.6, True)):
        gains = {"update": "none", "lambda": weight}
        composition, ticks, _ = simulate(gains, reference=step, control_period=0.5, duration=100.0)
        review = composition.review()
        assert bool(review.warnings) == warned
        assert "lambda_max(M^-1 K_D) = 1.86" in review.facts[0]
        assert len(review.facts) == 5
        settled = np.abs(block(ticks, "euler_error")[-1]).max() < 1e-6
        assert settled != warned


def test_the_force_on_a_free_floating_base_is_exactly_zero() -> None:
    """Bitwise, and the momentum of the robot stays what it was."""
    _, ticks, _ = simulate({"update": "composite"}, nominal=PRIOR, duration=20.0)
    assert not np.any([tick.output.command.wrench[:3] for tick in ticks])
    assert np.abs([tick.sample.telemetry["momentum"][:3] for tick in ticks]).max() < 1e-13


def test_on_the_reference_the_command_is_the_inverse_dynamics() -> None:
    """With exact parameters and no error, u is that of the body-frame model to 1e-12, free-floating and free-flying."""
    for name in ("panda_sat", "servicer"):
        robot, rng = load_robot(name), np.random.default_rng(5)
        model, law = NominalModel(robot), make_law("adaptive", robot, 0.1, {"update": "none", "gyroscopic": False})
        for _ in range(20):
            q = np.array([*rng.normal(size=3), *from_rpy(rng.uniform(-1.0, 1.0, 3)), *rng.uniform(-1, 1, robot.n)])
            v, a = rng.normal(size=(2, 6 + robot.n))
            state = RobotState(0, q, v, np.zeros(robot.n), np.zeros(3))
            u = law.update(state, Reference(0, q, v, a)).command.u
            wanted, _ = model.actuated_inverse_dynamics(q, v, a)
            assert np.abs(u - wanted).max() < 1e-12 * np.abs(wanted).max()


def test_the_momentum_of_the_wheels_is_dead_reckoned_and_used() -> None:
    """The law's sum of torques is the plant's wheel momentum, and knowing it removes most of the cross-axis error."""
    cross = {}
    for known in (True, False):
        ticks = simulate({"update": "none", "lead": True, "gyroscopic": known})[1]
        cross[known] = np.sqrt(np.mean(block(ticks, "euler_error")[:, 1:] ** 2))
    assert cross[True] < cross[False] / 10.0
    ticks = simulate({"update": "none"})[1]
    torque = np.array([tick.output.command.wrench[3:] for tick in ticks])
    wheels = np.array([tick.sample.telemetry["wheel_momentum"] for tick in ticks])
    assert wheels[1:] == pytest.approx(-0.25 * np.cumsum(torque, axis=0)[:-1], abs=1e-12)


def test_reset_makes_the_next_run_the_first() -> None:
    """After reset a law answers the same states with the same bits."""
    composition, ticks, _ = simulate({"update": "composite", "lead": True}, nominal=PRIOR, duration=10.0)
    law = composition.controller()
    for _ in range(2):
        law.reset()
        answers = [law.update(tick.sample.state, tick.reference) for tick in ticks]
        assert [bits(a) for a in answers] == [bits(tick.output) for tick in ticks]


def answer(law_gains: dict[str, Any], pitch_deg: float = 0.0, parameters: Vector | None = None) -> None:
    """One update of the law on `mini` at a pitch, with a nominal robot of these parameters."""
    robot = load_robot("mini")
    if parameters is not None:
        import pinocchio as pin

        model = robot.model.copy()
        for index, body in enumerate(parameters):
            model.inertias[index + 1] = pin.Inertia.FromDynamicParameters(body)
        robot = dataclasses.replace(robot, model=model)
    q = np.array([0, 0, 0, *from_rpy((0.0, np.radians(pitch_deg), 0.0)), *robot.home])
    state = RobotState(0, q, np.zeros(10), np.zeros(4), np.zeros(3))
    make_law("adaptive", robot, 0.25, law_gains).update(state, Reference(0, q, np.zeros(10), np.zeros(10)))


@pytest.mark.parametrize("pitch", [81.0, -81.0, 90.0])
def test_euler_singularity_is_refused_before_it_is_reached(pitch: float) -> None:
    """Beyond the limit the law ends the run with the angle and the limit, well before cos(pitch) vanishes."""
    answer({}, 79.0)
    with pytest.raises(ControlError, match=r"singularity.*-80 to 80 deg"):
        answer({}, pitch)


def test_a_path_through_the_singularity_is_refused_before_the_run() -> None:
    """A reference that pitches up to 85 degrees is bad input, found by the review."""
    composition = simulate({}, reference={"kind": "hold", "attitude_deg": [0, 85, 0]}, duration=1.0)[0]
    with pytest.raises(SpecError, match="singularity"):
        composition.review()


def test_a_prior_without_a_mass_matrix_is_a_named_error() -> None:
    """A nominal robot whose mass matrix is not positive definite has no K_D."""
    parameters = inertial_parameters(load_robot("mini"))
    parameters[0, [4, 6, 9]] = -1.0
    with pytest.raises(ControlError, match="not positive definite"):
        answer({}, parameters=parameters)


def test_a_lost_estimate_ends_the_run_with_its_name_and_finite_torques() -> None:
    """A step at a high Lyapunov gain loses the mass: the run says so, and no NaN was commanded on the way."""
    step = {"kind": "step", "attitude_deg": [60, 0, 0]}
    _, ticks, reason = simulate({"update": "lyapunov", "tracking": {"gain": 1e5}}, reference=step)
    assert "estimated mass is no longer positive" in reason
    assert np.isfinite([tick.output.command.u for tick in ticks]).all()


@pytest.mark.parametrize(
    ("gains", "said"),
    [
        ({"update": "magic"}, "controller.gains.update"),
        ({"lambda": -1.0}, "controller.gains.lambda"),
        ({"lambda": {"joints": [1.0]}}, "controller.gains.lambda.joints"),
        ({"lambda_": 1.0}, "controller.gains.lambda_"),
        ({"kappa": 0.0}, "controller.gains.kappa"),
        ({"pitch_limit_deg": 90.0}, "controller.gains.pitch_limit_deg"),
        ({"update": "lyapunov", "lambda_on": "velocity"}, "needs lambda_on: position"),
        ({"consistency": "natural"}, "for update lyapunov"),
        ({"rls": {"reset": {"samples": 0}}}, "controller.gains.rls.reset.samples"),
        ({"damping_inertia": [[1.0, 0.0], [0.0]]}, "controller.gains.damping_inertia"),
        ({"damping_inertia": [[1.0, 2.0], [2.0, 1.0]]}, "positive definite"),
        ({"damping_inertia": [[1.0, 0.0], [0.0, 1.0]]}, "accepted: 7 rows"),
    ],
)
def test_gains_that_cannot_be_used_are_named(gains: dict[str, Any], said: str) -> None:
    """Every bad gain is refused with its key before anything runs."""
    with pytest.raises(SpecError) as refused:
        make_law("adaptive", load_robot("mini"), 0.25, gains)
    assert said in str(refused.value)
