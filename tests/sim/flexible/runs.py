"""Flexible robots made of numbers, and runs of them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

import numpy as np

from space_robot_description.robot import Robot
from space_robot_msgs_py.interfaces import Command, PlantSample, Vector
from space_robot_sim.flexible.spec import FlexibilitySpec
from space_robot_sim.initial import InitialState
from space_robot_sim.plant import SimulatedRobot
from space_robot_sim.spec import IntegratorSpec
from tests.support.robots import arm_model, random_state, robot_of

PERIOD = 100_000_000
Kernel = Literal["auto", "pinocchio"]
KERNELS: tuple[Kernel, ...] = ("auto", "pinocchio")
PANEL: dict[str, Any] = {
    "name": "panel",
    "mass": 8.0,
    "hinge": [0.1, 0.8, -0.2],
    "axis": [1.0, 0.2, 0.0],
    "com": [0.0, 1.2, 0.1],
    "inertia": [4.0, 0.7, 4.5],
    "frequency": 0.4,
    "damping": 0.02,
    "start_deg": 3.0,
}
TANK: dict[str, Any] = {
    "name": "tank",
    "mass": 40.0,
    "at": [0.2, -0.1, 0.3],
    "frequency": 0.25,
    "damping": 0.05,
    "start": [0.02, -0.01, 0.03],
}
GEARS: dict[str, Any] = {"stiffness": 300.0, "damping": 0.5, "rotor_inertia": 1e-4, "gear_ratio": 100.0}
EVERYTHING = {"appendages": [PANEL], "slosh": [TANK], "joints": GEARS}


def spec_of(flexibility: Mapping[str, Any]) -> FlexibilitySpec:
    """What a file would say."""
    return FlexibilitySpec.model_validate(flexibility)


def plant_of(
    flexibility: Mapping[str, Any] | None, robot: Robot | None = None, kernel: Kernel = "auto", **keys: Any
) -> SimulatedRobot:
    """An arm of four joints on a 500 kg satellite, at rest."""
    robot = robot_of(arm_model(4)) if robot is None else robot
    rest = np.r_[np.zeros(6), 1.0, np.zeros(robot.n)], np.zeros(6 + robot.n)
    return SimulatedRobot(
        robot,
        control_period=PERIOD,
        initial=InitialState(*keys.pop("state", rest)),
        integrator=IntegratorSpec(kernel=kernel, **keys.pop("integrator", {})),
        flexibility=None if flexibility is None else spec_of(flexibility),
        **keys,
    )


def moving(joints: int = 4) -> tuple[Vector, Vector]:
    """A state in which everything turns."""
    return random_state(np.random.default_rng(3), joints, 0.05)


def simulate(plant: Any, periods: int, push: float = 0.0, joints: int = 4) -> list[PlantSample]:
    """The start and every period under commands of this size, which change their sign."""
    samples = [plant.reset()]
    for k in range(periods):
        wave = push * float(np.cos(0.7 * k))
        samples.append(plant.step(Command(k * PERIOD, wave * np.arange(1.0, 7.0), wave * np.linspace(1, 0.2, joints))))
    return samples


def block(samples: list[PlantSample], label: str) -> Vector:
    """A row per sample."""
    return np.array([sample.telemetry[label] for sample in samples])


def worst_residual(samples: list[PlantSample]) -> float:
    """Largest of momentum and energy."""
    return float(max(block(samples, label).max() for label in ("momentum_residual", "energy_residual")))
