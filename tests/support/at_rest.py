"""Robots that laws bring to rest, and the run that shows it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from space_robot_control.laws.base import Law
from space_robot_description.load import load_robot
from space_robot_description.robot import Robot
from space_robot_msgs_py.interfaces import PlantSample, Reference
from space_robot_sim.plant import InitialState, SimulatedRobot
from tests.support.robots import random_model, robot_of

ROBOTS = [load_robot("mini"), load_robot("servicer"), robot_of(random_model(np.random.default_rng(5), 6, serial=True))]
IDS = ["mini", "servicer", "arm"]


def samples_of_a_tumble(law: Law, robot: Robot, spin: float) -> Iterator[PlantSample]:
    """400 periods of 1 s of a robot that starts at home with random rates, those of the base of size spin [rad/s]."""
    rng, period = np.random.default_rng(3), 1_000_000_000
    q = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, *robot.home])
    v = np.concatenate([[0.0] * 3, rng.normal(size=3) * spin, rng.normal(size=robot.n) * 0.01])
    plant = SimulatedRobot(robot, control_period=period, initial=InitialState(q, v))
    sample = plant.reset()
    for _ in range(400):
        yield sample
        still = Reference(sample.state.stamp, q, np.zeros_like(v), np.zeros_like(v))
        sample = plant.step(law.update(sample.state, still).command)
    yield sample
