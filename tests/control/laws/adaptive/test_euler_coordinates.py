"""Euler coordinates against the rotations they come from."""

from __future__ import annotations

from math import tau

import numpy as np
import pinocchio as pin
import pytest

from space_robot_control.laws.adaptive.euler_coordinates import euler_state
from space_robot_control.laws.adaptive.kernel.euler import (
    accelerations,
    body_torque,
    generalised_torque,
    rates,
    short_way,
)
from space_robot_description import rotations as rot
from space_robot_msgs_py.interfaces import Reference
from tests.support.euler_coordinates import euler_acceleration

RNG = np.random.default_rng(3)
ANGLES = [tuple(RNG.uniform((-3.1, -1.4, -3.1), (3.1, 1.4, 3.1))) for _ in range(50)]


@pytest.mark.parametrize("rpy", ANGLES)
def test_rates_and_accelerations_invert_those_of_rotations(rpy: tuple[float, ...]) -> None:
    """Body rates and accelerations of a motion in roll, pitch, yaw give its derivatives back."""
    drpy, ddrpy = RNG.normal(size=3), RNG.normal(size=3)
    omega, alpha = rot.rpy_rates(rpy, drpy, ddrpy)
    assert rates(rpy, omega) == pytest.approx(drpy, abs=1e-12)
    assert accelerations(rpy, drpy, omega, alpha) == pytest.approx(ddrpy, abs=1e-11)


@pytest.mark.parametrize("rpy", ANGLES)
def test_generalised_torques_do_the_work_of_the_body_torque(rpy: tuple[float, ...]) -> None:
    """tau_Phi . Phi' = tau . omega for any rates, and the two conversions are inverse."""
    torque, drpy = RNG.normal(size=3), RNG.normal(size=3)
    omega, _ = rot.rpy_rates(rpy, drpy, np.zeros(3))
    generalised = generalised_torque(rpy, torque)
    assert np.dot(generalised, drpy) == pytest.approx(torque @ omega, abs=1e-12)
    assert body_torque(rpy, generalised) == pytest.approx(torque, abs=1e-12)


def test_coordinates_of_a_motion_are_its_derivatives() -> None:
    """The derivatives x' and x'' of a reference are the differences of x and x' along the motion that it belongs to."""
    model = pin.Model()
    joint = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root")
    model.addJoint(joint, pin.JointModelRZ(), pin.SE3.Identity(), "arm")
    q = np.array([0.3, -0.2, 0.1, *rot.from_rpy((0.4, -0.7, 1.9)), 0.5])
    v, a, h = RNG.normal(size=7), RNG.normal(size=7), 1e-4

    def at(t: float) -> tuple[np.ndarray, np.ndarray]:
        moved = pin.integrate(model, q, t * v + 0.5 * t * t * a)
        return euler_state(Reference(0, moved, v + t * a, a))

    (x0, dx0), (x1, dx1), (x2, dx2) = at(-h), at(0.0), at(h)
    assert (x2 - x0) / (2 * h) == pytest.approx(dx1, abs=1e-6)
    assert (dx2 - dx0) / (2 * h) == pytest.approx(euler_acceleration(Reference(0, q, v, a), x1, dx1), abs=1e-6)


def test_differences_go_the_short_way_round() -> None:
    """Angles just across half a turn are near each other, in both directions and over several turns."""
    for angle in (0.0, 0.1, -3.1, 3.1):
        for turns in range(-3, 4):
            assert short_way(angle + turns * tau) == pytest.approx(angle, abs=1e-12)
