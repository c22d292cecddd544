"""A robot under faults, for the tests of every kind."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from space_robot_msgs_py.interfaces import Command, PlantSample, Vector
from space_robot_sim.faults.base import Fault, FaultSite
from space_robot_sim.faults.catalogue import KINDS
from space_robot_sim.faults.plan import FaultPlan, plan_faults
from space_robot_sim.plant import InitialState, SimulatedRobot
from space_robot_sim.spec import IntegratorSpec, SensorSpec
from tests.support.robots import arm_model, random_state, robot_of

PERIOD, STEPS = 100_000_000, 40
WHEELS = {"base_torque": {"kind": "reaction_wheels", "torque": 2.0, "momentum": 50.0, "initial_momentum": (1, 2, -3)}}
Commands = Callable[[int], tuple[Vector, Vector]]


def fault(kind: str, **keys: Any) -> Fault:
    """A fault from its keys; ``at`` is 1 s where nothing is said."""
    return KINDS[kind].model_validate({"kind": kind, "at": 1.0} | keys)


def lively(tick: int) -> tuple[Vector, Vector]:
    """Wrench and efforts that keep every channel busy and change sign."""
    swing = np.cos(0.3 * tick)
    return swing * np.arange(1.0, 7.0), swing * np.linspace(0.8, 0.05, 7)


def simulated(
    faults: Sequence[Fault],
    *,
    actuators: dict[str, Any] | None = None,
    commands: Commands = lively,
    steps: int = STEPS,
    sensors: SensorSpec | None = None,
    seed: int = 5,
    kernel: Any = "auto",
) -> list[PlantSample]:
    """What a plant with these faults shows, from tick 0 to the last."""
    robot = robot_of(arm_model(), actuators, floating=actuators is WHEELS)
    site = FaultSite(robot, sensors or SensorSpec(), PERIOD * 1e-9, holds_payload=True)
    plan = plan_faults(faults, site, period=PERIOD, steps=steps, seed=seed) if faults else None
    plant = plant_of(robot, plan, sensors, kernel)
    samples = [plant.reset()]
    for tick in range(steps):
        samples.append(plant.step(Command(tick * PERIOD, *commands(tick))))
    return samples


def plant_of(robot: Any, plan: FaultPlan | None, sensors: SensorSpec | None, kernel: Any = "auto") -> SimulatedRobot:
    """A plant of this robot, moving."""
    return SimulatedRobot(
        robot,
        control_period=PERIOD,
        initial=InitialState(*random_state(np.random.default_rng(0), 7, 0.05)),
        integrator=IntegratorSpec(kernel=kernel),
        sensors=sensors,
        faults=plan,
    )


def block(samples: Sequence[PlantSample], label: str) -> Vector:
    """(K, size) one block of the plant's telemetry over time."""
    return np.array([sample.telemetry[label] for sample in samples])


def balances(samples: Sequence[PlantSample], most: float = 1e-9) -> bool:
    """Momentum and energy are accounted for at every tick."""
    residuals = [block(samples, label) for label in ("momentum_residual", "energy_residual", "quaternion_residual")]
    return bool(max(residual.max() for residual in residuals) < most)
