"""Joint brakes: they hold up to their torque and slip beyond it; momentum is kept, energy accounted for."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Command, PlantSample, Vector
from space_robot_sim.faults.base import FaultSite
from space_robot_sim.faults.joints import JointBrakeWeak
from space_robot_sim.faults.plan import plan_faults
from space_robot_sim.initial import InitialState
from space_robot_sim.plant import SimulatedRobot
from space_robot_sim.spec import HoldFor, IntegratorSpec
from tests.support.robots import arm_model, random_state, robot_of

PERIOD = 100_000_000
WHEELS = {"kind": "reaction_wheels", "torque": 2.0, "momentum": 50.0, "initial_momentum": (1, 2, -3)}
K = 2
EFFORT = 0.3


def plant_of(brake: float | tuple[float, ...], *, moving: bool = True, kernel: str = "auto", **keys: Any) -> Any:
    """An arm with brakes on a base with wheels that turn already."""
    joints = {"effort": 9.0, "lag": 0.05, "viscous": 0.01, "brake": brake}
    robot = robot_of(arm_model(), {"joints": joints, "base_torque": WHEELS}, floating=True)
    q, v = random_state(np.random.default_rng(0), 7, 0.2)
    initial = InitialState(q, v if moving else 0.0 * v)
    spec = IntegratorSpec(kernel=kernel)
    return SimulatedRobot(robot, control_period=PERIOD, initial=initial, integrator=spec, braked=True, **keys)


def efforts(size: float = EFFORT) -> Vector:
    """Of joint K alone."""
    return size * np.eye(7)[K]


def simulate(plant: Any, closed: str, effort: float = EFFORT) -> list[PlantSample]:
    """A period per letter, with brakes closed where it is ``c``."""
    samples = [plant.reset()]
    for tick, letter in enumerate(closed):
        plant.close_brakes(letter == "c")
        samples.append(plant.step(Command(tick * PERIOD, [0, 0, 0, 0.1, 0, -0.2], efforts(effort))))
    return samples


def block(samples: list[PlantSample], label: str) -> Vector:
    """A row per sample."""
    return np.array([sample.telemetry[label] for sample in samples])


def balances(samples: list[PlantSample]) -> bool:
    """Momentum and energy are accounted for."""
    worst = [block(samples, label).max() for label in ("momentum_residual", "energy_residual")]
    return bool(max(worst) < 1e-9)


def test_closed_brakes_hold_every_joint_and_keep_momentum() -> None:
    """While closed no joint moves, to the bit; momentum stays, energy is lost and counted; opened, joints move."""
    samples = simulate(plant_of(50.0), "oocccoo")
    rates, angles = block(samples, "true_velocity")[:, 6:], block(samples, "true_configuration")[:, 7:]
    assert not rates[3:6].any()
    assert angles[2:6].tobytes() == np.tile(angles[2], (4, 1)).tobytes()
    assert rates[6, K] != 0.0
    assert block(samples, "brakes").tolist() == [[float(letter == "c")] * 7 for letter in "ooocccoo"]
    energy = block(samples, "energy")[:, 0]
    assert energy[3] < energy[2]
    assert balances(samples)


@pytest.mark.parametrize(("factor", "holds"), [(1.01, True), (0.99, False)])
def test_a_brake_holds_up_to_its_torque(factor: float, holds: bool) -> None:
    """A motor of nearly as much does not move the joint, one of a little more does, and only that joint."""
    brake = tuple(np.where(np.arange(7) == K, factor * EFFORT, 50.0).tolist())
    plant = plant_of(brake, moving=False)
    samples = [plant.reset()]
    for tick in range(10):
        plant.close_brakes(True)
        samples.append(plant.step(Command(tick * PERIOD, np.zeros(6), efforts())))
    states = block(samples, "brakes")[1:]
    assert np.all(np.delete(states, K, axis=1) == 1.0)
    assert bool(states[-1, K] == 1.0) is holds
    assert bool(block(samples, "true_velocity")[-1, 6 + K]) is not holds
    assert balances(samples)


def test_a_fast_joint_slips_until_its_brake_can_stop_it() -> None:
    """Period by period it gets slower under a brake that is too weak to stop it at once; then it is held."""
    plant = plant_of(tuple(np.where(np.arange(7) == K, 2.5, 50.0).tolist()))
    samples = simulate(plant, "oooooooooo", effort=2.0)
    fast = abs(block(samples, "true_velocity")[-1, 6 + K])
    for tick in range(10, 40):
        plant.close_brakes(True)
        samples.append(plant.step(Command(tick * PERIOD, np.zeros(6), np.zeros(7))))
    speeds, states = np.abs(block(samples, "true_velocity")[11:, 6 + K]), block(samples, "brakes")[11:, K]
    held = int(np.argmax(states == 1.0))
    assert held > 2, (fast, speeds, states)
    assert np.all(np.diff([fast, *speeds[:held]]) < 0.0)
    assert not speeds[held:].any()
    assert np.all(states[held:] == 1.0)
    assert balances(samples)


def test_kernel_and_pinocchio_agree_on_brakes_that_hold_and_slip() -> None:
    """The compiled plant and the one over Pinocchio to 1e-12."""
    brake = tuple(np.where(np.arange(7) == K, 0.25, 50.0).tolist())
    ours, theirs = (simulate(plant_of(brake, kernel=kernel), "oocccccoo", 0.5) for kernel in ("auto", "pinocchio"))
    assert {-1.0, 1.0} <= set(block(ours, "brakes").ravel())
    for label in ("true_configuration", "true_velocity", "brakes"):
        np.testing.assert_allclose(block(ours, label), block(theirs, label), atol=1e-12)


def test_brakes_close_where_commands_are_missing_for_too_long() -> None:
    """``hold: {last_for: 2, brakes: true}``: from the third period without a command to the next one."""
    plant = plant_of(50.0, hold=HoldFor(last_for=2, brakes=True))
    plant.reset()
    given = [True, False, False, False, False, True]
    samples = [
        plant.step(Command(tick * PERIOD, np.zeros(6), efforts()) if there else None)
        for tick, there in enumerate(given)
    ]
    assert block(samples, "brakes")[:, 0].tolist() == [0.0, 0.0, 0.0, 1.0, 1.0, 0.0]


def test_a_weak_brake_gives_a_part_and_one_that_is_not_there_is_refused() -> None:
    """Of 0 it does not close: the motor moves the joint although the brakes are closed."""
    plant = plant_of(50.0, moving=False)
    fault = JointBrakeWeak.model_validate({"kind": "joint_brake_weak", "joint": "joint_2", "at": 0.2})
    site = FaultSite(robot_of(arm_model(), {"joints": {"effort": 9.0, "brake": 50.0}}))
    plan = plan_faults([fault], site, period=PERIOD, steps=6, seed=0)
    plant = plant_of(50.0, moving=False, faults=plan)
    states = block(simulate(plant, "cccccc"), "brakes")[1:]
    index = list(robot_of(arm_model()).joint_names).index("joint_2")
    assert states[:, index].tolist() == [1.0, 1.0, -1.0, -1.0, -1.0, -1.0]
    with pytest.raises(SpecError, match="no brake"):
        plan_faults([fault], FaultSite(robot_of(arm_model())), period=PERIOD, steps=6, seed=0)


def test_a_robot_without_closed_brakes_is_the_one_without_brakes() -> None:
    """Open brakes change no bit."""
    samples = simulate(plant_of(50.0), "oooo")
    plant = plant_of(0.0)
    others = simulate(plant, "oooo")
    assert block(samples, "true_velocity").tobytes() == block(others, "true_velocity").tobytes()
