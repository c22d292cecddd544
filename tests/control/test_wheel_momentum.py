"""Dead reckoning of the wheels' momentum against the plant's wheels."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from space_robot_control.wheel_momentum import WheelMomentum
from space_robot_description import Robot, load_robot
from space_robot_description.spec import ReactionWheels
from space_robot_msgs_py import Command
from space_robot_sim import InitialState, SimulatedRobot
from space_robot_sim.spec import IntegratorSpec

PERIOD = 250_000_000
PYRAMID = ((1.0, 0.0, 1.0), (-1.0, 0.0, 1.0), (0.0, 1.0, 1.0), (0.0, -1.0, 1.0))


def robot_with(wheels: dict[str, object], saturation: str) -> Robot:
    """Mini with other wheels."""
    robot = load_robot("mini")
    base_torque = ReactionWheels(torque=1.5, momentum=2.0).model_copy(update=wheels)
    actuators = robot.actuators.model_copy(update={"base_torque": base_torque, "saturation": saturation})
    return replace(robot, actuators=actuators)


@pytest.mark.parametrize("saturation", ["per_axis", "direction_preserving"])
@pytest.mark.parametrize(
    ("wheels", "size"),
    [
        ({}, 1.0),
        ({}, 4.0),
        ({"axes": PYRAMID, "initial_momentum": (1.0, -1.0, 0.5, 0.0)}, 4.0),
        ({"initial_momentum": (1.9, -1.9, 0.0)}, 1.0),
    ],
    ids=["within limits", "beyond the torque", "pyramid", "nearly full"],
)
def test_the_momentum_is_that_of_the_plant(wheels: dict[str, object], size: float, saturation: str) -> None:
    """Whatever is commanded, the reckoned momentum is that of the plant's wheels, and no phantom of clipped torques."""
    robot = robot_with(wheels, saturation)
    q0, v0 = np.zeros(7 + robot.n), np.zeros(6 + robot.n)
    q0[6], q0[7:] = 1.0, robot.home
    plant = SimulatedRobot(robot, control_period=PERIOD, initial=InitialState(q0, v0), integrator=IntegratorSpec())
    law, rng = WheelMomentum(robot), np.random.default_rng(3)
    axes = np.array(robot.actuators.base_torque.axes)  # type: ignore[union-attr]
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    sample = plant.reset()
    for k in range(40):
        np.testing.assert_allclose(law.momentum, sample.telemetry["wheel_momentum"] @ axes, rtol=0.0, atol=1e-12)
        command = Command(
            k * PERIOD, np.array([0.0, 0.0, 0.0, *size * rng.normal(size=3)]), 0.01 * rng.normal(size=robot.n)
        )
        law.apply(command.u, PERIOD / 1e9)
        sample = plant.step(command)


def test_the_torque_of_turning_wheels_is_added() -> None:
    """A base that turns at omega needs omega x h beside all else; a robot without wheels needs nothing."""
    wheels, u = WheelMomentum(robot_with({"initial_momentum": (0.5, -1.0, 1.5)}, "per_axis")), np.arange(10.0)
    omega = np.array((0.3, 0.2, -0.1))
    wheels.add_torque(u, omega)
    added = u - np.arange(10.0)
    np.testing.assert_allclose(added, [0, 0, 0, *np.cross(omega, (0.5, -1.0, 1.5)), 0, 0, 0, 0], atol=1e-15)
    without = WheelMomentum(load_robot("servicer"))
    assert not without.present
    without.add_torque(u, omega)
    np.testing.assert_array_equal(u - np.arange(10.0), added)
