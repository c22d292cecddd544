"""The adaptive law is its reference: the paper's equations with explicit M, C, Y and covariance."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from space_robot_control.laws.adaptive import reference
from space_robot_control.laws.adaptive.law import Adaptive
from space_robot_control.laws.adaptive.reference_dynamics import Dynamics
from space_robot_control.laws.adaptive.regressor import Regressor
from space_robot_control.references import make_reference
from space_robot_description.load import load_robot
from space_robot_description.robot import Robot
from space_robot_description.rotations import from_rpy
from space_robot_msgs_py.interfaces import ControlOutput, Reference, RobotState, Vector
from tests.support.closed_loop import closed_loop, off
from tests.support.coupled_robots import random_coupled
from tests.support.robots import random_model, robot_of

PERIOD = 0.25
# Actuators that nothing saturates and no wheels: the reference has neither.
ROBOTS = {
    "mini": robot_of(load_robot("mini").model, floating=True),
    "servicer": robot_of(load_robot("servicer").model),
    "arm": robot_of(random_model(np.random.default_rng(4), 5, serial=True), floating=True),
    "followers": robot_of(random_coupled(np.random.default_rng(6), 7, serial=True).model, floating=True),
}
UPDATES = ("none", "rls", "rls_filtered", "lyapunov", "composite")


def pair(robot: Robot, gains: dict[str, Any]) -> tuple[Adaptive, reference.Adaptive]:
    """The law and its reference, of the same gains."""
    values = gains | {"rls": {"reset": None, **gains.get("rls", {})}}
    law = Adaptive(robot, PERIOD, Adaptive.Gains.model_validate(values))
    g, floating = law.gains, robot.base_mode == "free_floating"
    first = 3 if floating else 0
    noise = np.array([g.rls.force_noise] * 3 + [g.rls.torque_noise] * (3 + robot.n))
    return law, reference.Adaptive(
        robot.model,
        PERIOD,
        Lambda=g.lambda_.values(robot, "lambda")[first:],
        kappa=g.kappa,
        update=g.update,
        lambda_on=g.lambda_on,
        free_floating=floating,
        translation=g.rls.translation,
        noise=noise[first:],
        prior=(g.rls.prior_spread, g.rls.prior_floor),
        b=g.rls.bandwidth,
        gamma=g.tracking.gain,
        floor=g.tracking.floor,
    )


def some_gains(robot: Robot, update: str, rng: np.random.Generator) -> dict[str, Any]:
    """Random gains, every one that the reference has; no single state moves the estimate out of what is possible."""
    axes = rng.uniform(0.1, 2.0, size=(2, 3)).tolist()
    readings = ["position"] if update in ("lyapunov", "composite") else ["position", "velocity"]
    return {
        "update": update,
        "lambda": {"translation": axes[0], "rotation": axes[1], "joints": rng.uniform(0.1, 2.0, robot.n).tolist()},
        "lambda_on": readings[rng.integers(len(readings))],
        "kappa": rng.uniform(0.2, 2.0),
        "rls": {
            "torque_noise": rng.uniform(100.0, 1000.0),
            "force_noise": rng.uniform(100.0, 1000.0),
            "prior_spread": rng.uniform(0.01, 0.1),
            "prior_floor": rng.uniform(1e-4, 1e-2),
            "bandwidth": rng.uniform(0.1, 2.0),
            "translation": ["model", "accelerometer", "velocity"][rng.integers(3)],
        },
        "tracking": {"gain": 10.0 ** rng.uniform(-6.0, -4.0), "floor": rng.uniform(1e-4, 1e-2)},
    }


def some_state(rng: np.random.Generator, n: int, stamp: int) -> tuple[RobotState, Reference]:
    """A random state and a random moving reference away from the singularity."""

    def configuration() -> Vector:
        rpy = rng.uniform((-3.0, -1.2, -3.0), (3.0, 1.2, 3.0))
        return np.array([*rng.normal(size=3), *from_rpy(rpy), *rng.uniform(-2.0, 2.0, n)])

    v, v_d, a_d = 0.3 * rng.normal(size=(3, 6 + n))
    state = RobotState(stamp, configuration(), v, rng.normal(size=n), rng.normal(size=3))
    return state, Reference(stamp, configuration(), v_d, a_d)


def check(
    law: Adaptive, equations: reference.Adaptive, ticks: list[tuple[RobotState, Reference, ControlOutput]]
) -> None:
    """Commands, sigma and the estimate that each carries on agree to 1e-12 of the largest."""
    found: dict[str, list[Vector]] = {"u": [], "sigma": [], "pi_hat": []}
    expected: dict[str, list[Vector]] = {"u": [], "sigma": [], "pi_hat": []}
    floating = law.robot.base_mode == "free_floating"
    order = [2, 1, 0] if floating else [0, 1, 2, 5, 4, 3]  # telemetry has roll first, the coordinates have yaw first
    for state, desired, output in ticks:
        telemetry = output.telemetry
        values = state.q, state.v, desired.q, desired.v, desired.a, state.effort, state.base_acceleration
        expected["u"].append(equations.update(*values))
        sigma = equations.sigma
        expected["sigma"].append(np.concatenate([sigma[order], sigma[len(order) :]]))
        expected["pi_hat"].append(equations.pi_used)
        found["u"].append(output.command.u)
        found["sigma"].append(telemetry["sliding_variable"])
        found["pi_hat"].append(telemetry["parameters"])
    for name in found:
        assert off(found[name], expected[name]) < 1e-12, name


@pytest.mark.parametrize("robot", ROBOTS)
def test_the_explicit_matrices_are_the_regressor_and_c_is_christoffels(robot: str) -> None:
    """Y equals Pinocchio's polarised regressor, Y pi = M x_r'' + C x_r', and M' - 2 C is skew."""
    rng, model, n, h = np.random.default_rng(2), ROBOTS[robot].model, ROBOTS[robot].n, 1e-6
    regressor = Regressor(ROBOTS[robot])
    pi = np.array(regressor.parameters)
    x, dx, dx_r, ddx_r = rng.uniform(-1.0, 1.0, size=(4, 6 + n))
    at = Dynamics(model, x, dx)
    assert off(at.Y(dx_r, ddx_r), regressor.slotine_li(x, dx, dx_r, ddx_r)) < 1e-12
    assert off(at.Y(dx_r, ddx_r) @ pi, at.M(pi) @ ddx_r + at.C(pi) @ dx_r) < 1e-12
    change = (Dynamics(model, x + h * dx, dx).M(pi) - Dynamics(model, x - h * dx, dx).M(pi)) / (2 * h)
    skew = change - 2.0 * at.C(pi)
    assert np.abs(skew + skew.T).max() < 1e-7 * np.abs(change).max()


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("update", UPDATES)
def test_adaptive_equals_its_reference_in_random_states(update: str, robot: str) -> None:
    """Over random states, references and gains, with every update, floating and free-flying."""
    rng = np.random.default_rng(3)
    for _ in range(4):
        law, equations = pair(ROBOTS[robot], some_gains(ROBOTS[robot], update, rng))
        pairs = [some_state(rng, law.n, stamp) for stamp in range(3)]
        check(law, equations, [(state, desired, law.update(state, desired)) for state, desired in pairs])


@pytest.mark.parametrize(
    ("robot", "update"), [*(("mini", update) for update in UPDATES), ("servicer", "rls"), ("servicer", "composite")]
)
def test_adaptive_equals_its_reference_in_a_closed_loop(robot: str, update: str) -> None:
    """Over a run in which the robot is heavier than its model, estimate and covariance carried on."""
    nominal = ROBOTS[robot]
    truth = robot_of(nominal.model.copy(), floating=nominal.base_mode == "free_floating")
    for body in range(1, truth.model.njoints):
        nominal_body = nominal.model.inertias[body]
        heavier = pin.Inertia(1.2 * nominal_body.mass, nominal_body.lever, 1.2 * nominal_body.inertia)
        truth.model.inertias[body] = heavier
    law, equations = pair(
        nominal, {"update": update, "rls": {"torque_noise": 0.1, "force_noise": 0.1, "bandwidth": 2.0}}
    )
    q = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, *load_robot(robot).home])
    wave = {"amplitude_deg": 10.0, "frequency": 0.05}
    motion = {"kind": "harmonic", "roll": wave, "joints": {nominal.joint_names[1]: wave}, "soft_start": 2.0}
    ticks = closed_loop(law, truth, make_reference(motion, nominal, q), q, 25)
    check(law, equations, ticks)
    parameters = [output.telemetry["parameters"] for _, _, output in ticks]
    assert (off(parameters[-1], parameters[0]) > 1e-3) == (update != "none")
