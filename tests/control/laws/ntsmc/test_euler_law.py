"""The Euler-angle baseline: angles that count turns, rates that are theirs, and a law that is the same but for them."""

from __future__ import annotations

from math import cos, pi
from typing import Any

import numpy as np
import pytest

from space_robot_control.laws import make_law
from space_robot_control.laws.ntsmc.angle_branch import AngleBranch, euler_rates, wrapped
from space_robot_control.laws.ntsmc.euler_law import NtsmcEuler
from space_robot_control.laws.ntsmc.kernel.sliding import EQUIVALENT, REACHING
from space_robot_control.laws.ntsmc.kernel.terminal import DESIRED, E
from space_robot_control.references import make_reference
from space_robot_description import rotations as rot
from space_robot_msgs_py.interfaces import Reference, RobotState
from tests.support.robots import arm_model, random_state, robot_of
from tests.support.simulated import errors, simulate, start

N = 4
ROBOT = robot_of(arm_model(N))
ZERO = np.zeros(6 + N)


def law_of(**gains: Any) -> NtsmcEuler:
    law = make_law("ntsmc_euler", ROBOT, 0.1, gains)
    assert isinstance(law, NtsmcEuler)
    return law


def turned(*rpy: float) -> RobotState:
    """At rest with these angles."""
    q = np.concatenate([np.zeros(3), rot.from_rpy(rpy), np.zeros(N)])
    return RobotState(0, q, ZERO, np.zeros(N), np.zeros(3))


def error_of(law: NtsmcEuler, *rpy: float) -> list[float]:
    state, reference = turned(*rpy), Reference(0, turned(0.0, 0.0, 0.0).q, ZERO, ZERO)
    return law.rotation(state, reference)[E].tolist()


def test_angles_follow_a_motion_through_turns_and_the_singular_pitch() -> None:
    """Along a smooth motion of roll, pitch and yaw over several turns the branch gives back exactly those angles."""
    angles = np.array([[4.0, 2.5, -7.0]]) * np.linspace(0.0, 1.0, 400)[:, None]
    branch = AngleBranch((0.0, 0.0, 0.0))
    found = np.array([branch.nearest(rot.from_rpy(rpy)) for rpy in angles])
    assert np.abs(angles[:, 1]).max() > pi / 2
    np.testing.assert_allclose(found, angles, atol=1e-9)


def test_the_law_follows_the_same_branch() -> None:
    """Along that motion the compiled law has the angles that ``AngleBranch`` gives."""
    law, branch = law_of(), AngleBranch((0.0, 0.0, 0.0))
    for rpy in np.array([[4.0, 2.5, -7.0]]) * np.linspace(0.0, 1.0, 100)[:, None]:
        error = error_of(law, *rpy)
        np.testing.assert_allclose(error, branch.nearest(rot.from_rpy(rpy)), rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("start_deg", [(-225.0, 90.0, -225.0), (-315.0, 30.0, -225.0), (80.0, -60.0, 100.0)])
def test_the_first_angles_are_those_nearest_to_the_start(start_deg: tuple[float, ...]) -> None:
    """The displacements of Appendix B are kept as they are said, beyond half a turn and at the singularity too."""
    found = AngleBranch(tuple(np.radians(start_deg))).nearest(rot.from_rpy(np.radians(start_deg)))  # type: ignore[arg-type]
    np.testing.assert_allclose(np.degrees(found), start_deg, atol=1e-5)


@pytest.mark.parametrize("seed", range(20))
def test_rates_are_the_inverse_of_the_body_rates_of_rpy(seed: int) -> None:
    """euler_rates undoes rpy_rates away from the singularity, and near it stays within the floor's bound."""
    rng = np.random.default_rng(seed)
    rpy, rates = rng.uniform(-1.4, 1.4, 3), rng.normal(size=3)
    omega, _ = rot.rpy_rates(rpy, rates, (0.0, 0.0, 0.0))
    np.testing.assert_allclose(euler_rates(rpy.tolist(), omega, 1e-3), rates, atol=1e-12)
    near = euler_rates((rpy[0], pi / 2, rpy[2]), omega, 1e-3)
    assert np.linalg.norm(near) <= 1.5e3 * np.linalg.norm(omega)


def test_wrapped_errors_lie_within_half_a_turn_and_unwrapped_ones_count() -> None:
    """The same attitude is 270 degrees away for a state that has turned and 90 for a wrapped one."""
    unwrapped, plain = law_of(start_deg=(-270.0, 0.0, 0.0)), law_of(angles="wrapped", start_deg=(-270.0, 0.0, 0.0))
    np.testing.assert_allclose(np.degrees(error_of(unwrapped, -1.5 * pi, 0.0, 0.0)), [-270.0, 0.0, 0.0], atol=1e-9)
    np.testing.assert_allclose(np.degrees(error_of(plain, -1.5 * pi, 0.0, 0.0)), [90.0, 0.0, 0.0], atol=1e-9)
    unwrapped.reset()
    assert wrapped(error_of(unwrapped, 0.1, 0.0, 0.0)[0]) == pytest.approx(0.1)


def test_for_a_small_error_about_one_axis_both_laws_are_one_with_half_the_error() -> None:
    """As eps is half the angle, the quaternion law at 2 theta commands what the Euler law commands at theta."""
    u = {}
    for name, angle in (("ntsmc", 2e-3), ("ntsmc_euler", 1e-3)):
        goal = Reference(0, turned(0.0, 0.0, 0.0).q, ZERO, ZERO)
        u[name] = make_law(name, ROBOT, 0.1).update(turned(0.0, 0.0, angle), goal).command.u
    np.testing.assert_allclose(u["ntsmc"], u["ntsmc_euler"], rtol=1e-5, atol=1e-9)


@pytest.mark.parametrize("seed", range(10))
def test_the_commanded_acceleration_is_that_of_the_angles(seed: int) -> None:
    """With the command, theta'' of the moving body is the desired one plus a2 + a3, by central differences."""
    rng = np.random.default_rng(seed)
    (q, v), (q_d, v_d) = (random_state(rng, N, 0.2) for _ in range(2))
    q[3:7], q_d[3:7] = (rot.from_rpy(rng.uniform(-1.0, 1.0, 3)) for _ in range(2))
    state = RobotState(0, q, v, np.zeros(N), np.zeros(3))
    reference = Reference(0, q_d, v_d, rng.normal(size=6 + N) * 0.1)
    law = law_of()
    pushes = law.rotation(state, reference)[DESIRED]
    terms = law.memory.terms[:, 3:6]
    wanted, alpha, h = pushes + terms[EQUIVALENT] + terms[REACHING], law.memory.acceleration[3:6], 1e-5
    rates = []
    for t in (-h, h):
        quaternion = rot.product(q[3:7], rot.exp(t * v[3:6] + 0.5 * t * t * alpha))
        rpy = AngleBranch(rot.to_rpy(q[3:7])).nearest(quaternion)
        rates.append(euler_rates(rpy, v[3:6] + t * alpha, 1e-3))
    np.testing.assert_allclose((np.array(rates[1]) - rates[0]) / (2 * h), wanted, atol=1e-6)


@pytest.mark.parametrize("angles", ["wrapped", "unwrapped"])
def test_a_moderate_error_converges(angles: str) -> None:
    """Away from the singularity the baseline is a working controller."""
    reference = make_reference({"kind": "hold"}, ROBOT, start())
    rows = simulate(law_of(angles=angles, clamp=True), reference, ROBOT, start((0.5, -0.4, 0.7)), 0.1, 600)
    assert np.abs(errors(rows, "attitude_error")[-1]).max() < 1e-4
    assert np.abs(errors(rows, "position_error")[-1]).max() < 1e-4


@pytest.mark.parametrize("pitch", [pi / 2, -pi / 2, 1.5707963])
def test_the_command_is_finite_at_the_singularity(pitch: float) -> None:
    """cos(pitch) = 0 has a command, moving or not."""
    for omega in (0.0, 0.3):
        state = turned(0.4, pitch, -0.2)
        v = ZERO.copy()
        v[3:6] = omega
        moving = RobotState(0, state.q, v, np.zeros(N), np.zeros(3))
        u = law_of().update(moving, Reference(0, turned(0.0, 0.0, 0.0).q, ZERO, ZERO)).command.u
        assert np.isfinite(u).all()
    assert abs(cos(pitch)) < 1e-3
