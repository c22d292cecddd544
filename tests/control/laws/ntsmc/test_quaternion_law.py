"""The quaternion law: the short way round, finite everywhere, within the actuators; its equations: test_reference."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from space_robot_control.laws import make_law
from space_robot_control.laws.ntsmc.kernel.terminal import E_DOT, E
from space_robot_control.laws.ntsmc.quaternion_law import Ntsmc
from space_robot_control.references import make_reference
from space_robot_description import rotations as rot
from space_robot_description.load import load_robot
from space_robot_description.robot import Robot
from space_robot_msgs_py.interfaces import Reference, RobotState
from tests.support.robots import arm_model, random_state, robot_of
from tests.support.simulated import errors, simulate, start

N = 4
WIDE = robot_of(arm_model(N))
FLOATING = robot_of(arm_model(N), floating=True)


def pair(seed: int, speed: float = 0.3) -> tuple[RobotState, Reference]:
    """A random state and a random moving reference."""
    rng = np.random.default_rng(seed)
    (q, v), (q_d, v_d) = (random_state(rng, N, speed) for _ in range(2))
    return RobotState(0, q, v, np.zeros(N), np.zeros(3)), Reference(0, q_d, v_d, rng.normal(size=6 + N))


def law_of(robot: Robot, period: float = 0.1, **gains: Any) -> Ntsmc:
    law = make_law("ntsmc", robot, period, gains)
    assert isinstance(law, Ntsmc)
    return law


def test_the_short_way_is_taken_from_a_thousand_attitudes() -> None:
    """The sliding error points against the shortest rotation, whichever of the two quaternions is measured."""
    rng, law, zero = np.random.default_rng(5), law_of(WIDE), np.zeros(6 + N)
    for _ in range(1000):
        q, q_d = (random_state(rng, N)[0] for _ in range(2))
        flipped = q.copy()
        flipped[3:7] *= -1.0
        answers = []
        for measured in (q, flipped):
            state, reference = RobotState(0, measured, zero, np.zeros(N), np.zeros(3)), Reference(0, q_d, zero, zero)
            found = law.rotation(state, reference)
            answers.append(found[E].tolist())
        assert answers[0] == answers[1]
        to_goal = np.array(rot.rotate(q[3:7], rot.log(rot.relative(q[3:7], q_d[3:7]))))
        angle = np.linalg.norm(to_goal)
        np.testing.assert_allclose(found[E], -np.sin(angle / 2) * to_goal / angle, atol=1e-12)


@pytest.mark.parametrize("seed", range(20))
def test_the_derivative_of_the_quaternion_error_holds_for_a_turning_reference(seed: int) -> None:
    """eps_e' = (eta_e w_e - eps_e x (w_b + w_d)) / 2 against central differences along both motions."""
    state, reference = pair(seed, speed=1.0)
    law, h = law_of(WIDE), 1e-6

    def at(t: float) -> Any:
        q = pin.integrate(WIDE.model, state.q, state.v * t)
        q_d = pin.integrate(WIDE.model, reference.q, reference.v * t)
        moved = RobotState(0, q, state.v, np.zeros(N), np.zeros(3)), Reference(0, q_d, reference.v, reference.a)
        return law.rotation(*moved)

    change = (at(h)[E] - at(-h)[E]) / (2 * h)
    np.testing.assert_allclose(change, at(0.0)[E_DOT], atol=1e-8)
    now, omega_d = at(0.0), np.array(rot.rotate(reference.q[3:7], reference.v[3:6]))
    without = now[E_DOT] + np.cross(now[E], omega_d)
    assert np.abs(change - without).max() > 1e-3


@pytest.mark.parametrize("clamp", [False, True])
@pytest.mark.parametrize("angle_deg", [0.0, 90.0, 180.0, 180.0 + 1e-12, 359.0])
@pytest.mark.parametrize("robot", [WIDE, FLOATING], ids=["free-flying", "free-floating"])
def test_the_command_is_finite_at_rest_and_at_half_a_turn(robot: Robot, angle_deg: float, clamp: bool) -> None:
    """0/0 at rest, eta_e = 0 and 180 degrees all have a command; away from the goal it is not zero."""
    q, zero = start(), np.zeros(6 + N)
    q_d = q.copy()
    q_d[3:7] = rot.exp((0.0, 0.0, np.radians(angle_deg)))
    state = RobotState(0, q, zero, np.zeros(N), np.zeros(3))
    u = law_of(robot, clamp=clamp).update(state, Reference(0, q_d, zero, zero)).command.u
    assert np.isfinite(u).all()
    assert (np.abs(u).max() > 0.0) == (angle_deg > 0.0)


def test_free_floating_base_is_controlled_without_force() -> None:
    """Translation has no sliding variable, the force is 0.0 to the bit, and rotation and joints converge."""
    goal = {"kind": "hold", "joints": [0.0, 0.4, -0.2, 0.9]}
    reference = make_reference(goal, FLOATING, start())
    rows = simulate(law_of(FLOATING, clamp=True), reference, FLOATING, start((0.6, -0.5, 0.8)), 0.1, 800)
    assert all(u[:3].tolist() == [0.0, 0.0, 0.0] for _, _, u in rows)
    assert rows[0][1]["sliding_variable"].size == 3 + N
    assert np.abs(errors(rows, "attitude_error")[-1]).max() < 1e-4
    assert np.abs(errors(rows, "joint_error")[-1]).max() < 1e-4


def test_the_law_remembers_nothing_across_a_reset() -> None:
    """The same states and references give the same bits after a reset, K_hat and the observer included."""
    law = law_of(WIDE, disturbance_observer=0.5)
    outputs = []
    for _ in range(2):
        law.reset()
        outputs.append([law.update(*pair(seed)) for seed in range(5)])
    for first, second in zip(*outputs, strict=True):
        assert first.command.u.tobytes() == second.command.u.tobytes()
        assert first.telemetry.data.tobytes() == second.telemetry.data.tobytes()


def test_the_adapted_gain_in_the_log_is_the_one_that_was_used() -> None:
    """K_hat of the first answer is its initial value; it grows by T phi |xi| (1 + |x'|^2)."""
    law, (state, reference) = law_of(WIDE), pair(3)
    first, second = (law.update(state, reference).telemetry for _ in range(2))
    growth = 0.1 * 1e-3 * np.abs(first["xi"]) * (1.0 + state.v @ state.v)
    assert first["adaptive_gain"].tolist() == [1e-4] * (6 + N)
    np.testing.assert_allclose(second["adaptive_gain"], 1e-4 + growth, rtol=1e-13)


def test_the_observer_takes_off_a_roughly_known_load_and_is_off_by_default() -> None:
    """With a load the model half knows, the largest joint error falls to less than a half with the observer."""
    nominal, truth = (robot_of(arm_model(N)) for _ in range(2))
    truth.model.inertias[5] = truth.model.inertias[5] + pin.Inertia(8.0, np.array([0.0, 0.0, 0.4]), np.eye(3))
    nominal.model.inertias[5] = nominal.model.inertias[5] + pin.Inertia(4.0, np.array([0, 0, 0.4]), 0.5 * np.eye(3))
    spec = {"kind": "quintic", "duration": 20.0, "joints_by_deg": 40.0}
    reference, worst = make_reference(spec, nominal, start()), []
    for share in (0.0, 0.5):
        rows = simulate(law_of(nominal, disturbance_observer=share), reference, truth, start(), 0.1, 200)
        assert np.any(errors(rows, "disturbance_estimate")) == (share > 0.0)
        worst.append(np.abs(errors(rows, "joint_error")).max())
    assert worst[1] < 0.5 * worst[0]


@pytest.mark.parametrize("saturation", ["per_axis", "direction_preserving"])
def test_saturated_commands_fit_the_nominal_actuators(saturation: str) -> None:
    """From half a turn away the servicer is asked for more than it has; what is sent fits, and telemetry says so."""
    robot = load_robot("servicer")
    q = np.concatenate([np.zeros(3), rot.exp((0.0, 3.0, 0.5)), robot.home])
    q_d, zero = q.copy(), np.zeros(6 + robot.n)
    q_d[3:7] = [0.0, 0.0, 0.0, 1.0]
    state = RobotState(0, q, zero, np.zeros(robot.n), np.zeros(3))
    output = law_of(robot, saturation=saturation).update(state, Reference(0, q_d, zero, zero))
    limits = [60.0] * 3 + [20.0] * 3 + robot.effort_limit.tolist()
    wanted = output.telemetry["command_unsaturated"]
    assert output.telemetry["command_saturated"].tolist() == [1.0]
    assert np.any(np.abs(wanted) > limits)
    assert np.all(np.abs(output.command.u) <= limits)
    assert output.telemetry["command_norm"][0] == pytest.approx(np.linalg.norm(wanted))
    if saturation == "direction_preserving":
        scale = output.command.u @ wanted / (wanted @ wanted)
        np.testing.assert_allclose(output.command.u, scale * wanted, atol=1e-9)


@pytest.mark.parametrize(
    ("period", "clamp", "warned"), [(0.1, False, 0), (0.25, False, 1), (0.5, False, 2), (1.0, True, 0)]
)
def test_the_review_warns_of_chatter_and_cycles(period: float, clamp: bool, warned: int) -> None:
    """At Table I the wrist chatters above 0.1 s and cycles above 0.5 s; the clamp is the way out."""
    robot = load_robot("servicer")
    q, zero = np.concatenate([np.zeros(3), [0, 0, 0, 1.0], robot.home]), np.zeros(14)
    q_d = q.copy()
    q_d[3:7] = rot.exp((0.0, 1.0, 0.5))
    review = law_of(robot, period, clamp=clamp).review([Reference(0, x, zero, zero) for x in (q, q_d, q_d)])
    assert len(review.warnings) == warned
    assert "loop gain" in review.facts[0]
    assert all("clamp: true" in warning for warning in review.warnings)
