"""The model-free law is its reference: the paper's two equations with explicit matrices."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from space_robot_control.laws.mfac.law import ModelFree
from space_robot_control.laws.mfac.reference import Mfac
from space_robot_control.laws.mfac.tuning import tuning
from space_robot_control.references import make_reference
from space_robot_description.load import load_robot
from space_robot_description.robot import Robot
from space_robot_msgs_py.interfaces import ControlOutput, Reference, RobotState
from tests.support.closed_loop import closed_loop, off, random_pair
from tests.support.coupled_robots import random_coupled
from tests.support.robots import random_model, robot_of

PERIOD = 0.25
MAX_CONDITION = 20.0  # of phi: (16) squares it, and 1e-12 is asked of the result
# The reference has no limits: here nothing reaches them, and increments in their units still move the estimator.
WIDE = {
    "joints": {"effort": 1e6},
    "base_torque": {"kind": "ideal", "limit": (2e6, 1e6, 3e6)},
    "base_force": {"kind": "thrusters", "limit": (1e6, 2e6, 3e6)},
}
ROBOTS = {
    "mini": robot_of(load_robot("mini").model, WIDE | {"base_force": None}, floating=True),
    "servicer": robot_of(load_robot("servicer").model, WIDE),
    "arm": robot_of(random_model(np.random.default_rng(4), 5, serial=True), WIDE),
    "followers": robot_of(random_coupled(np.random.default_rng(6), 7, serial=True).model, WIDE),
}
Ticks = list[tuple[RobotState, Reference, ControlOutput]]


def pair(robot: Robot, gains: dict[str, Any]) -> tuple[ModelFree, Mfac]:
    """The law and its reference, of the same gains."""
    law = ModelFree(robot, PERIOD, ModelFree.Gains.model_validate(gains))
    g, names = law.gains, ["x", "y", "z", "roll", "pitch", "yaw", *robot.joint_names]
    chosen = tuning(g, law.channels, PERIOD)
    return law, Mfac(
        robot.model,
        PERIOD,
        [names.index(name) for name in law.channels.names],
        rho=chosen.rho,
        kappa=chosen.kappa,
        limit=law.channels.limits(),
        c=chosen.lead if g.form == "rate_augmented" else None,
        held=[names.index(name) for name in g.held],
        home=[float(robot.home[robot.joint_names.index(name)]) for name in g.held],
        lambda_=g.control_weight,
        orders=(g.output_order, g.input_order),
        sigma=g.estimator.sigma,
        beta=g.estimator.beta,
        floor=g.estimator.floor,
        scale=g.initial.scale,
        units=g.units,
    )


def some_gains(robot: Robot, rng: np.random.Generator) -> dict[str, Any]:
    """Random gains, every one that the reference has, of a random choice of channels, one joint held."""
    held, *joints = rng.permutation(robot.joint_names).tolist()
    base = ["roll", "pitch", "yaw"] if robot.base_mode == "free_floating" else ["x", "y", "z", "roll", "pitch", "yaw"]
    outputs = rng.permutation([*base, *joints])[: rng.integers(1, 4 + len(joints))].tolist()
    return {
        "outputs": outputs,
        "held": [held],
        "form": ["rate_augmented", "position"][rng.integers(2)],
        "lead": {name: rng.uniform(0.5, 5.0) for name in outputs},
        "rho": [None, rng.uniform(0.01, 1.0)][rng.integers(2)],
        "kappa": rng.uniform(0.0, 5.0),
        "control_weight": [0.0, rng.uniform(0.0, 1.0)][rng.integers(2)],
        "units": ["full_scale", "printed"][rng.integers(2)],
        "output_order": int(rng.integers(2, 4)),
        "input_order": int(rng.integers(1, 4)),
        "estimator": {
            "sigma": [0.0, rng.uniform(0.05, 2.0)][int(rng.random() > 0.2)],
            "beta": 10.0 ** rng.uniform(-6.0, 0.0),
            "floor": rng.uniform(0.05, 0.9),
        },
        "initial": {"scale": rng.uniform(0.5, 2.0)},
    }


def check(equations: Mfac, ticks: Ticks) -> bool:
    """Commands, and the Phi that each carries on, agree to 1e-12 of the largest; False: phi is not well conditioned."""
    expected, phi, condition = [], [], 0.0
    for state, desired, _ in ticks:
        expected.append(equations.update(state.q, state.v, desired.q, desired.v))
        of_input = equations.phi(equations.orders[0])
        condition = max(condition, float(np.linalg.cond(of_input)))
        phi.append(np.linalg.inv(equations.S_y) @ of_input @ np.linalg.inv(equations.S_u))
    if condition > MAX_CONDITION:
        return False
    assert not np.any([output.telemetry["saturated"] for _, _, output in ticks])
    assert off([output.command.u for _, _, output in ticks], expected) < 1e-12
    found = [output.telemetry["pseudo_gradient"].reshape(phi[0].shape) for _, _, output in ticks]
    assert off(found, phi) < 1e-12
    return True


@pytest.mark.parametrize("robot", ROBOTS)
def test_mfac_equals_its_reference_in_random_states(robot: str) -> None:
    """Over random states, references, gains, channels and orders."""
    rng, resets, checked = np.random.default_rng(1), 0.0, 0
    for _ in range(100):
        law, equations = pair(ROBOTS[robot], some_gains(ROBOTS[robot], rng))
        pairs = [random_pair(rng, law.n, stamp) for stamp in range(4)]
        ticks = [(state, desired, law.update(state, desired)) for state, desired in pairs]
        if check(equations, ticks):
            checked += 1
            resets += ticks[-1][2].telemetry["resets"][0]
    assert checked > 30
    assert resets > 0.0


@pytest.mark.parametrize(("name", "limit"), [("mini", 3.0), ("servicer", 300.0)])
@pytest.mark.parametrize("form", ["rate_augmented", "position"])
def test_mfac_equals_its_reference_in_a_closed_loop(form: str, name: str, limit: float) -> None:
    """Over a run on a moving reference, with the Phi that was learned carried on."""
    rho = {"rho": 0.05, "kappa": 2.0} if form == "position" else {}
    home = load_robot(name).home
    torque = {"kind": "ideal", "limit": (limit, 0.5 * limit, 2.0 * limit)}
    robot = robot_of(
        load_robot(name).model, {"base_torque": torque}, floating=ROBOTS[name].base_mode == "free_floating"
    )
    names, estimator = ["roll", "pitch", "yaw"], {"sigma": 0.5, "beta": 1e-4}
    gains = {"form": form, "outputs": names, "held": robot.joint_names, "estimator": estimator}
    law, equations = pair(robot, gains | rho)
    q = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, *home])
    goal = {"kind": "quintic", "duration": 6.0, "attitude_deg": [20, -10, 30]}
    ticks = closed_loop(law, robot, make_reference(goal, robot, q), q, 60)
    assert check(equations, ticks)
    phi = [output.telemetry["pseudo_gradient"] for _, _, output in (ticks[0], ticks[-1])]
    assert off(phi[1], phi[0]) > 1e-6
