"""A constant disturbance of the base: the motion that mechanics says, balances that close, both integrators alike."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import pytest

from space_robot_bringup import load_experiment
from space_robot_msgs_py.interfaces import Command, PlantSample
from space_robot_sim.plant import InitialState, SimulatedRobot
from space_robot_sim.spec import DisturbanceSpec, IntegratorSpec
from tests.support.robots import arm_model, random_state, robot_of

PERIOD = 100_000_000
KERNELS: tuple[Literal["auto", "pinocchio"], ...] = ("auto", "pinocchio")


def _run(
    disturbance: DisturbanceSpec | None,
    kernel: Literal["auto", "pinocchio"] = "auto",
    *,
    joints: int = 4,
    **options: Any,
) -> list[PlantSample]:
    state = random_state(np.random.default_rng(3), joints, 0.05)
    plant = SimulatedRobot(
        robot_of(arm_model(joints)),
        control_period=PERIOD,
        initial=InitialState(*options.get("state", state)),
        integrator=IntegratorSpec(kernel=kernel),
        disturbance=disturbance,
    )
    push = options.get("push", 0.0)
    commands = (Command(k * PERIOD, push * np.arange(1.0, 7.0), push * np.ones(joints)) for k in range(30))
    return [plant.reset(), *map(plant.step, commands)]


@pytest.mark.parametrize("kernel", KERNELS)
def test_a_force_moves_the_centre_of_mass_on_a_parabola(kernel: Literal["auto", "pinocchio"]) -> None:
    """Momentum about the inertial origin grows by F t, whatever arm and attitude do meanwhile."""
    force = np.array([0.3, -0.2, 0.1])
    first, *_, last = _run(DisturbanceSpec(force=(0.3, -0.2, 0.1), at=(0.2, 0.1, -0.3)), kernel, push=1e-9)
    gained = (last.telemetry["momentum"] - first.telemetry["momentum"])[:3]
    np.testing.assert_allclose(gained, 3.0 * force, rtol=1e-6)


@pytest.mark.parametrize("kernel", KERNELS)
def test_a_body_torque_turns_a_body_about_its_axis(kernel: Literal["auto", "pinocchio"]) -> None:
    """Without joints a torque about a principal axis gives omega = T t / I and the angle T t^2 / 2 I."""
    rest = np.array([0, 0, 0, 0, 0, 0, 1.0]), np.zeros(6)
    last = _run(DisturbanceSpec(torque=(0, 0, 0.6)), kernel, joints=0, state=rest)[-1].state
    assert last.v[5] == pytest.approx(0.6 * 3.0 / 120.0, rel=1e-12)
    assert 2.0 * np.arctan2(last.q[5], last.q[6]) == pytest.approx(0.5 * 0.6 * 9.0 / 120.0, rel=1e-12)


@pytest.mark.parametrize("kernel", KERNELS)
def test_balances_close_with_a_disturbance(kernel: Literal["auto", "pinocchio"]) -> None:
    """Its impulse, moment and work are counted like those of the actuators, beside which it acts."""
    samples = _run(DisturbanceSpec(force=(3, -2, 1), at=(0.2, 0.1, -0.3), torque=(0.5, 0.1, -0.4)), kernel, push=0.1)
    for sample in samples:
        assert sample.telemetry["momentum_residual"].max() < 1e-12
        assert sample.telemetry["energy_residual"].max() < 1e-12
    assert abs(samples[-1].telemetry["energy"][0] - samples[0].telemetry["energy"][0]) > 0.01


def test_both_integrators_agree_on_a_disturbance() -> None:
    """The compiled kernel and the one over Pinocchio give the same motion."""
    spec = DisturbanceSpec(force=(3, -2, 1), at=(0.2, 0.1, -0.3), torque=(0.5, 0.1, -0.4))
    one, two = (_run(spec, kernel)[-1].state for kernel in KERNELS)
    np.testing.assert_allclose(np.r_[one.q, one.v], np.r_[two.q, two.v], rtol=0.0, atol=1e-11)


def test_nothing_said_is_nothing_in_the_file() -> None:
    """The plant section of a run without a disturbance has no key of that name, and one with it keeps it."""
    experiment = load_experiment("liu2023/fig08")
    assert "disturbance" not in experiment.plant.model_dump(mode="json")
    pushed = load_experiment("point_to_point/disturbed")
    assert pushed.plant.model_dump(mode="json")["disturbance"]["torque"] == [0.0, 0.0, 0.002]
