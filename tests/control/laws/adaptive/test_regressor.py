"""The linear separation: Y pi is the inverse dynamics, exactly, on the shipped robots."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from space_robot_control.laws.adaptive.euler_coordinates import euler_state
from space_robot_control.laws.adaptive.regressor import Regressor
from space_robot_control.nominal_model import NominalModel
from space_robot_description.load import load_robot
from space_robot_description.robot import Robot
from space_robot_msgs_py.interfaces import Reference, Vector
from tests.support.robots import random_state

ROBOTS = ("mini", "servicer", "panda_sat")
STATES = 100  # of each robot


def robot_and_regressor(name: str) -> tuple[Robot, Regressor]:
    robot = load_robot(name)
    return robot, Regressor(robot)


def random_motion(rng: np.random.Generator, n: int) -> tuple[Vector, ...]:
    """Coordinates away from the singularity, and three vectors of its size."""
    x = rng.uniform(-2.0, 2.0, 6 + n)
    x[4] = rng.uniform(-1.3, 1.3)
    return x, *rng.normal(size=(3, 6 + n))


def independent_model(robot: Robot) -> pin.Model:
    """The same robot with the base on three translations and three revolutes of the URDF's own kind."""
    base = pin.JointModelComposite(4)
    for joint in (pin.JointModelTranslation(), pin.JointModelRZ(), pin.JointModelRY(), pin.JointModelRX()):
        base.addJoint(joint)
    model = pin.buildModelFromXML(robot.urdf, base)
    model.gravity.setZero()
    return model


@pytest.mark.parametrize("name", ROBOTS)
def test_regressor_times_parameters_is_the_inverse_dynamics(name: str) -> None:
    """Yp pi = rnea to 1e-12 of the largest force, 100 random states each, with a model built another way."""
    robot, regressor = robot_and_regressor(name)
    model = independent_model(robot)
    data, rng = model.createData(), np.random.default_rng(1)
    for _ in range(STATES):
        x, dx, ddx, _ = random_motion(rng, robot.n)
        force = pin.rnea(model, data, x, dx, ddx)
        found = regressor.inverse_dynamics(x, dx, ddx) @ regressor.parameters
        assert np.abs(found - force).max() < 1e-12 * np.abs(force).max()


@pytest.mark.parametrize("name", ROBOTS)
def test_slotine_li_regressor_is_mass_times_acceleration_plus_coriolis_times_velocity(name: str) -> None:
    """Y pi = M a_r + C v_r to 1e-12 with the Christoffel C of Pinocchio, 100 random states each."""
    robot, regressor = robot_and_regressor(name)
    model = regressor._model  # its base is single joints, for which pin.computeCoriolisMatrix is right
    data, rng = model.createData(), np.random.default_rng(2)
    for _ in range(STATES):
        x, dx, dx_r, ddx_r = random_motion(rng, robot.n)
        inertial, coriolis = regressor.mass_matrix(x) @ ddx_r, pin.computeCoriolisMatrix(model, data, x, dx) @ dx_r
        found = regressor.slotine_li(x, dx, dx_r, ddx_r) @ regressor.parameters
        scale = np.abs(inertial).max() + np.abs(coriolis).max()
        assert np.abs(found - inertial - coriolis).max() < 1e-12 * scale


@pytest.mark.parametrize("name", ROBOTS)
def test_mass_rate_minus_twice_coriolis_is_skew(name: str) -> None:
    """M' - 2 C is skew-symmetric with the C that the regressor contains, to the accuracy of a central difference."""
    robot, regressor = robot_and_regressor(name)
    rng, zero, h = np.random.default_rng(3), np.zeros(6 + robot.n), 1e-6
    for _ in range(10):
        x, dx, _, _ = random_motion(rng, robot.n)
        columns = [regressor.slotine_li(x, dx, e, zero) @ regressor.parameters for e in np.eye(6 + robot.n)]
        rate = (regressor.mass_matrix(x + h * dx) - regressor.mass_matrix(x - h * dx)) / (2.0 * h)
        difference = rate - 2.0 * np.array(columns).T
        assert np.abs(difference + difference.T).max() < 1e-7 * np.abs(rate).max()


@pytest.mark.parametrize("name", ROBOTS)
def test_euler_mass_matrix_has_the_energy_of_the_twist(name: str) -> None:
    """x'^T M(x) x' in Euler coordinates is v^T M(q) v in those of the data flow."""
    robot, regressor = robot_and_regressor(name)
    nominal, rng = NominalModel(robot), np.random.default_rng(4)
    for _ in range(20):
        q, v = random_state(rng, robot.n)
        x, dx = euler_state(Reference(0, q, v, v))
        energy = v @ nominal.mass_matrix(q) @ v
        assert dx @ regressor.mass_matrix(x) @ dx == pytest.approx(energy, rel=1e-12)


def test_neither_position_nor_velocity_of_the_base_enters() -> None:
    """Only its acceleration does, which is why the zero-force rows give the translation."""
    robot, regressor = robot_and_regressor("mini")
    x, dx, ddx, other = random_motion(np.random.default_rng(5), robot.n)
    moved, drifting = x.copy(), dx.copy()
    moved[:3], drifting[:3] = other[:3], other[3:6]
    here, there = regressor.inverse_dynamics(x, dx, ddx), regressor.inverse_dynamics(moved, drifting, ddx)
    assert np.abs(here - there).max() < 1e-12 * np.abs(here).max()
    force = regressor.inertia(x, np.array([*ddx[:3], *np.zeros(3 + robot.n)])) @ regressor.parameters
    assert force[:3] == pytest.approx(NominalModel(robot).mass * ddx[:3], rel=1e-12)
