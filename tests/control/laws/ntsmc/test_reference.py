"""The sliding mode laws are their references: the paper's equations with explicit matrices, term by term."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from space_robot_control.laws import make_law
from space_robot_control.laws.ntsmc.reference import Gains, Ntsmc, quaternion
from space_robot_control.laws.ntsmc.reference_euler import EulerAngles
from space_robot_control.laws.ntsmc.terminal_sliding import TerminalSliding
from space_robot_control.references import make_reference
from space_robot_description.load import load_robot
from space_robot_description.robot import Robot
from tests.support.closed_loop import closed_loop, off, random_pair
from tests.support.coupled_robots import random_coupled
from tests.support.robots import arm_model, random_model, robot_of

PERIOD = 0.1
# Actuators that nothing saturates: the references have no limits.
SERVICER, MINI = load_robot("servicer").model, load_robot("mini").model
ROBOTS = {
    "servicer": robot_of(SERVICER),
    "mini, floating": robot_of(MINI, floating=True),
    "arm": robot_of(arm_model(4)),
    "arm, floating": robot_of(arm_model(4), floating=True),
    "random": robot_of(random_model(np.random.default_rng(2), 5, serial=True)),
    "followers": robot_of(random_coupled(np.random.default_rng(6), 7, serial=True).model, floating=True),
}
LAWS = ("ntsmc", "ntsmc_euler")


def pair(name: str, robot: Robot, gains: dict[str, Any]) -> tuple[TerminalSliding, Ntsmc]:
    """The law and its reference, of the same gains."""
    law = make_law(name, robot, PERIOD, gains)
    assert isinstance(law, TerminalSliding)
    g, floating = law.gains, robot.base_mode == "free_floating"
    first, e = 3 if floating else 0, g.exponents
    values = Gains(
        Gamma=g.gamma_of(robot)[first:],
        K_1=g.k1,
        K_2=g.k2_of(robot)[first:],
        Phi=g.boundary_layer,
        phi=g.adaptation.rate,
        K_hat_0=g.adaptation.initial,
        r=e.q / e.p,
        p1_q1=e.p1 / e.q1,
        p2_q2=e.p2 / e.q2,
    )
    rotation: Any = quaternion
    if name == "ntsmc_euler":
        extra = law.gains.model_dump()
        rotation = EulerAngles(np.radians(extra["start_deg"]), wrapped=extra["angles"] == "wrapped")
    return law, Ntsmc(robot.model, PERIOD, values, rotation, free_floating=floating)


def some_gains(name: str, robot: Robot, rng: np.random.Generator) -> dict[str, Any]:
    """Random gains, every one that the reference has."""

    def per_dof(low: float, high: float) -> dict[str, Any]:
        axes = rng.uniform(low, high, size=(2, 3)).tolist()
        return {"translation": axes[0], "rotation": axes[1], "joints": rng.uniform(low, high, robot.n).tolist()}

    gains = {
        "gamma": per_dof(0.05, 0.5),
        "k1": rng.uniform(0.0, 0.1),
        "k2": per_dof(0.05, 0.8),
        "boundary_layer": rng.uniform(5e-4, 1e-2),
        "exponents": {"p": 7, "q": int(rng.integers(8, 13)), "p2": int(rng.integers(3, 9)), "q2": 9},
        "adaptation": {"initial": rng.uniform(0.0, 1e-2), "rate": rng.uniform(0.0, 1.0)},
    }
    if name == "ntsmc_euler":
        gains |= {"angles": ["wrapped", "unwrapped"][rng.integers(2)], "start_deg": rng.uniform(-400, 400, 3).tolist()}
    return gains


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("name", LAWS)
def test_ntsmc_equals_the_paper_term_by_term(name: str, robot: str) -> None:
    """u, s, Delta s, xi and K_hat agree to 1e-12 of the largest entry over random states, references and gains."""
    rng = np.random.default_rng(1)
    for _ in range(20):
        law, reference = pair(name, ROBOTS[robot], some_gains(name, ROBOTS[robot], rng))
        for stamp in range(3):
            state, desired = random_pair(rng, ROBOTS[robot].n, stamp)
            k_hat = reference.K_hat
            u = reference.update(state.q, state.v, desired.q, desired.v, desired.a)
            output = law.update(state, desired)
            telemetry = output.telemetry
            assert off(output.command.u, u) < 1e-12
            assert off(telemetry["sliding_variable"], reference.s) < 1e-12
            assert off(telemetry["sliding_excess"], reference.Delta_s) < 1e-12
            assert off(telemetry["xi"], reference.xi) < 1e-12
            assert off(telemetry["adaptive_gain"], k_hat) < 1e-12


@pytest.mark.parametrize("robot", ["servicer", "mini, floating"])
@pytest.mark.parametrize("name", LAWS)
def test_ntsmc_equals_the_paper_in_a_closed_loop(name: str, robot: str) -> None:
    """Commands and the K_hat that each carries on agree to 1e-12 of the largest over a run from a large error."""
    law, reference = pair(name, ROBOTS[robot], {"adaptation": {"rate": 1e-2}})
    q = np.array([0.0, 0.0, 0.0, 0.3, -0.2, 0.5, np.sqrt(0.62), *load_robot(robot.partition(",")[0]).home])
    goal = make_reference({"kind": "quintic", "duration": 5.0, "attitude_deg": [20, -10, 30]}, ROBOTS[robot], q)
    ticks = closed_loop(law, ROBOTS[robot], goal, q, 100)
    expected, k_hat = [], []
    for state, desired, _ in ticks:
        k_hat.append(reference.K_hat)
        expected.append(reference.update(state.q, state.v, desired.q, desired.v, desired.a))
    assert off([output.command.u for _, _, output in ticks], expected) < 1e-12
    assert off([output.telemetry["adaptive_gain"] for _, _, output in ticks], k_hat) < 1e-12
