"""Oscillations of a free robot at the frequencies that mechanics says."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from space_robot_description.mass_matrix import mass_matrix
from space_robot_sim.flexible.modes import mode_frequencies
from space_robot_sim.flexible.parts import FlexibleParts
from tests.sim.flexible.runs import KERNELS, PERIOD, Kernel, block, plant_of, simulate, spec_of, worst_residual
from tests.support.robots import arm_model, robot_of

# 500 kg, diag(90, 110, 120) kg m2 about the origin, with everything that is taken out of it.
BODY = robot_of(arm_model(0))
MASS = np.diag([500.0, 500.0, 500.0, 90.0, 110.0, 120.0])
SECONDS = PERIOD / 1e9


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("axis", [(1.0, 0.0, 0.0), (0.6, 0.0, 0.8)])
def test_a_panel_on_a_free_base_swings_faster_by_its_modal_coupling(axis: tuple[float, ...], kernel: Kernel) -> None:
    """omega_free / omega_cantilevered = 1 / sqrt(1 - L^T M^-1 L / I), L the momentum at a unit rate of the hinge."""
    hinge, com, mass, frequency = np.array([0.1, 0.8, -0.2]), np.array([0.0, 1.2, 0.1]), 6.0, 0.4
    inertia = np.diag([3.0, 0.6, 3.4])
    panel = {"name": "panel", "mass": mass, "hinge": hinge.tolist(), "axis": axis, "com": com.tolist()}
    panel |= {"inertia": np.diag(inertia).tolist(), "frequency": frequency, "damping": 0.0, "start_deg": 1e-3}
    a = np.array(axis)
    linear = mass * np.cross(a, com)
    coupling = np.r_[linear, inertia @ a + np.cross(hinge + com, linear)]
    about_hinge = a @ inertia @ a + np.cross(a, com) @ linear
    ratio = 1.0 / np.sqrt(1.0 - coupling @ np.linalg.solve(MASS, coupling) / about_hinge)
    assert ratio > 1.1
    samples = simulate(plant_of({"appendages": [panel]}, BODY, kernel), 100, joints=0)
    angle = block(samples, "flexible_panel")[:, 0]
    time = SECONDS * np.arange(angle.size)
    wanted = np.radians(1e-3) * np.cos(2.0 * np.pi * frequency * ratio * time)
    np.testing.assert_allclose(angle, wanted, atol=1e-8 * np.radians(1e-3) * 100)
    (found,) = mode_frequencies(FlexibleParts(spec_of({"appendages": [panel]}), BODY).rates)
    assert found == pytest.approx(frequency * ratio, rel=1e-9)


@pytest.mark.parametrize("kernel", KERNELS)
def test_fuel_on_a_free_body_oscillates_about_the_common_centre(kernel: Kernel) -> None:
    """Reduced mass m (M - m) / M on spring and damper, and the body moves so that the centre of mass stays."""
    mass, total, frequency, ratio, start = 80.0, 500.0, 0.3, 0.03, 0.05
    tank = {"name": "tank", "mass": mass, "at": [0.0, 0.0, 0.0], "axes": ["x"], "frequency": frequency}
    tank |= {"damping": ratio, "start": [start, 0.0, 0.0]}
    samples = simulate(plant_of({"slosh": [tank]}, BODY, kernel), 100, joints=0)
    x, time = block(samples, "flexible_tank_x")[:, 0], SECONDS * np.arange(101)
    stretch = total / (total - mass)
    decay = ratio * 2.0 * np.pi * frequency * stretch
    omega = np.sqrt((2.0 * np.pi * frequency) ** 2 * stretch - decay**2)
    wanted = start * np.exp(-decay * time) * (np.cos(omega * time) + decay / omega * np.sin(omega * time))
    np.testing.assert_allclose(x, wanted, atol=1e-10)
    place = block(samples, "true_configuration")[:, 0]
    np.testing.assert_allclose(place, mass / total * (start - x), atol=1e-12)


@pytest.mark.parametrize("kernel", KERNELS)
def test_motor_and_link_oscillate_against_each_other(kernel: Kernel) -> None:
    """A constant torque twists the gear by tau / (B omega^2) (1 - cos omega t), omega^2 = k (1 / B + 1 / J)."""
    stiffness, rotor, gear, torque = 40.0, 2e-4, 100.0, 1e-6
    robot = robot_of(arm_model(1))
    full = mass_matrix(robot.model, np.r_[np.zeros(6), 1.0, 0.0])
    link = full[6, 6] - full[6, :6] @ np.linalg.solve(full[:6, :6], full[:6, 6])
    behind = gear**2 * rotor
    omega = np.sqrt(stiffness * (1.0 / behind + 1.0 / link))
    joints = {"stiffness": stiffness, "rotor_inertia": rotor, "gear_ratio": gear}
    plant = plant_of({"joints": joints}, robot, kernel)
    samples = [plant.reset()]
    samples += [plant.step(_effort(k, torque)) for k in range(50)]
    twist = block(samples, "motor_position")[:, 0] - block(samples, "true_configuration")[:, 7]
    largest = torque / behind / omega**2
    np.testing.assert_allclose(twist, largest * (1.0 - np.cos(omega * SECONDS * np.arange(51))), atol=1e-6 * largest)
    (found,) = mode_frequencies(FlexibleParts(spec_of({"joints": joints}), robot).rates)
    assert 2.0 * np.pi * found == pytest.approx(omega, rel=1e-9)
    assert worst_residual(samples) < 1e-11


def test_a_body_at_rest_is_the_body_of_the_robot_file() -> None:
    """What swings is taken out of its link: with relaxed springs the mass matrix is the one that laws know."""
    robot = robot_of(arm_model(4))
    q = np.r_[np.zeros(6), 1.0, 0.3, -0.2, 0.5, 0.1]
    known = mass_matrix(robot.model, q)
    panel = {"name": "p", "mass": 8.0, "axis": [1, 0, 0], "com": [0, 1, 0], "hinge": [0, 0.5, 0], "frequency": 1.0}
    tank = {"name": "t", "mass": 30.0, "at": [0.1, 0.2, 0.3], "frequency": 0.5}
    model = FlexibleParts(spec_of({"appendages": [panel], "slosh": [tank]}), robot).model(robot)
    np.testing.assert_allclose(mass_matrix(model, np.r_[q, np.zeros(4)])[:10, :10], known, atol=1e-12)
    added = FlexibleParts(spec_of({"slosh": [tank | {"added": True}]}), robot).model(robot)
    assert mass_matrix(added, np.r_[q, np.zeros(3)])[0, 0] == pytest.approx(known[0, 0] + 30.0)


def _effort(tick: int, torque: float) -> Any:
    from space_robot_msgs_py.interfaces import Command

    return Command(tick * PERIOD, np.zeros(6), np.array([torque]))
