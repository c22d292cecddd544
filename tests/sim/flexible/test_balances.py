"""Momentum and energy of flexible robots balance in every combination; both integrators agree."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Command
from space_robot_sim.capture import FreeBody, RobotChange
from space_robot_sim.faults.base import FaultSite
from space_robot_sim.faults.joints import JointFriction, JointStuck
from space_robot_sim.faults.plan import plan_faults
from space_robot_sim.spec import DisturbanceSpec
from tests.sim.flexible.runs import (
    EVERYTHING,
    GEARS,
    KERNELS,
    PANEL,
    PERIOD,
    TANK,
    Kernel,
    block,
    moving,
    plant_of,
    simulate,
    worst_residual,
)
from tests.support.coupled_robots import random_coupled
from tests.support.robots import arm_model, random_state, robot_of

BODIES = {"appendages": [PANEL], "slosh": [TANK]}
ROUGH = {"effort": 1e3, "lag": 0.05, "viscous": 0.3, "coulomb": 0.02, "brake": 1e3}
WHEELS = {"kind": "reaction_wheels", "torque": 2.0, "momentum": 50.0, "initial_momentum": (1, 2, -3)}


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize(
    "flexibility",
    [{"appendages": [PANEL]}, {"slosh": [TANK]}, {"joints": GEARS}, EVERYTHING],
    ids=lambda one: "+".join(one),
)
def test_momentum_and_energy_balance(flexibility: dict[str, Any], kernel: Kernel) -> None:
    """With springs and rotors in the energy and dampers in the work, residuals are those of a rigid robot."""
    samples = simulate(plant_of(flexibility, kernel=kernel, state=moving()), 30, push=2.0)
    assert worst_residual(samples) < 1e-10
    assert block(samples, "flexible_energy").max() > 1e-3


@pytest.mark.parametrize("actuators", [{"joints": ROUGH}, {"base_torque": WHEELS}], ids=["friction and lag", "wheels"])
def test_balances_close_with_rough_motors_wheels_and_a_disturbance(actuators: dict[str, Any]) -> None:
    """Friction acts on the motors' side of gears, wheels and pushes on the base as ever."""
    robot = robot_of(arm_model(4), actuators)
    push = DisturbanceSpec(force=(3, -2, 1), at=(0.2, 0.1, -0.3), torque=(0.5, 0.1, -0.4))
    samples = simulate(plant_of(EVERYTHING, robot, state=moving(), disturbance=push), 30, push=2.0)
    assert worst_residual(samples) < 1e-9


def test_what_a_free_robot_loses_is_in_the_dampers() -> None:
    """Without actuators energy and dissipated energy have a constant sum, and the first falls."""
    samples = simulate(plant_of(EVERYTHING, state=moving()), 60)
    energy, lost = block(samples, "energy")[:, 0], block(samples, "dissipated_energy")[:, 0]
    np.testing.assert_allclose(energy + lost, energy[0], rtol=1e-11)
    assert np.all(np.diff(lost) > 0.0)
    assert lost[-1] > 0.01 * energy[0]


def test_both_integrators_agree_on_everything_flexible() -> None:
    """The compiled kernel and the one over Pinocchio give the same motion."""
    found, expected = (simulate(plant_of(EVERYTHING, kernel=one, state=moving()), 30, 2.0) for one in KERNELS)
    for label in ("true_configuration", "true_velocity", "flexible_panel", "flexible_tank_z", "motor_position"):
        np.testing.assert_allclose(block(found, label), block(expected, label), rtol=0.0, atol=1e-10)


@pytest.mark.parametrize("kernel", KERNELS)
def test_stiff_springs_move_like_no_springs(kernel: Kernel) -> None:
    """A panel and a tank of 30 Hz follow their link as if fixed to it."""
    stiff = {"frequency": 30.0, "damping": 0.1}
    still = {"appendages": [PANEL | stiff | {"start_deg": 0.0}], "slosh": [TANK | stiff | {"start": [0, 0, 0]}]}
    found = simulate(plant_of(still, kernel=kernel, state=moving()), 20, 2.0)
    expected = simulate(plant_of(None, kernel=kernel, state=moving()), 20, 2.0)
    difference = block(found, "true_configuration") - block(expected, "true_configuration")
    assert np.abs(difference).max() < 1e-4


def test_a_reset_gives_the_same_run() -> None:
    """Hidden joints and motors begin again where they began."""
    plant = plant_of(EVERYTHING, state=moving())
    first, second = (simulate(plant, 5, 2.0) for _ in range(2))
    assert first[-1].telemetry.data.tobytes() == second[-1].telemetry.data.tobytes()


def test_sensors_at_the_motors_read_the_motors() -> None:
    """joint_position is the motor's over its ratio, the truth is the link's; by default both are the link's."""
    for side, label in (("motor", "motor_position"), ("link", "true_configuration")):
        samples = simulate(plant_of({"joints": GEARS | {"measured": side}}, state=moving()), 10, 2.0)
        read = np.array([sample.state.q[7:] for sample in samples])
        assert read.tobytes() == np.ascontiguousarray(block(samples, label)[:, -4:]).tobytes()
        assert np.abs(block(samples, "motor_position") - block(samples, "true_configuration")[:, 7:]).max() > 1e-4


def test_only_the_named_gears_twist() -> None:
    """Joints without a stiffness are rigid: motor and link have one angle."""
    gears = {"stiffness": {"joint_1": 300.0}, "rotor_inertia": {"joint_1": 0.5}}
    samples = simulate(plant_of({"joints": gears}, state=moving()), 10, 2.0)
    twist = block(samples, "motor_position") - block(samples, "true_configuration")[:, 7:]
    assert np.flatnonzero(np.abs(twist).max(axis=0)).tolist() == [1]


@pytest.mark.parametrize("kernel", KERNELS)
def test_a_body_that_is_caught_is_balanced(kernel: Kernel) -> None:
    """Panels and fuel take part in the impact; the residuals go on through it."""
    import pinocchio as pin

    robot = robot_of(arm_model(4))
    body = pin.Inertia(30.0, np.array([0.0, 0.0, 0.3]), np.diag([1.0, 2.0, 2.0]))
    model = robot.model.copy()
    model.inertias[5] = model.inertias[5] + body
    laden = robot_of(model)
    change = RobotChange(10 * PERIOD, laden, FreeBody(5, body, (0.05, 0.0, 0.02), (0.1, -0.05, 0.02)))
    samples = simulate(plant_of(EVERYTHING, robot, kernel, state=moving(), changes=(change,)), 20, 2.0)
    assert worst_residual(samples) < 1e-10
    jump = block(samples, "true_velocity")[11] - block(samples, "true_velocity")[10]
    assert np.abs(jump).max() > 1e-3


def test_brakes_and_stuck_joints_of_rigid_gears_compose_with_panels_and_fuel() -> None:
    """A held joint stands still to the bit while panels and fuel go on; balances close."""
    robot = robot_of(arm_model(4), {"joints": {"effort": 1e3, "brake": 50.0}})
    plant = plant_of(BODIES, robot, state=moving(), braked=True)
    plant.reset()
    plant.close_brakes(closed=True)
    samples = [plant.step(Command(k * PERIOD, np.zeros(6), np.zeros(4))) for k in range(10)]
    assert not block(samples, "true_velocity")[:, 6:].any()
    assert np.ptp(block(samples, "flexible_panel")[:, 0]) > 0.01
    assert worst_residual(samples) < 1e-10
    stuck = plan_faults((JointStuck(joint="joint_2", at=0.5),), FaultSite(robot), period=PERIOD, steps=20, seed=0)
    samples = simulate(plant_of(BODIES, robot, state=moving(), faults=stuck), 20, 2.0)
    assert not block(samples, "true_velocity")[7:, 8].any()
    assert worst_residual(samples) < 1e-10


def test_friction_that_jumps_acts_at_the_motor() -> None:
    """A fault of a flexible gear's friction composes, and takes energy."""
    robot = robot_of(arm_model(4))
    plan = plan_faults(
        (JointFriction(joint="joint_1", at=0.5, viscous=5.0),), FaultSite(robot), period=PERIOD, steps=20, seed=0
    )
    samples = simulate(plant_of({"joints": GEARS}, robot, state=moving(), faults=plan), 20)
    assert worst_residual(samples) < 1e-9


@pytest.mark.parametrize(("what", "key"), [("brakes", "plant.flexibility.joints"), ("stuck", "faults.0.joint")])
def test_brakes_of_flexible_gears_are_refused(what: str, key: str) -> None:
    """They hold links in this plant, and real ones the motor."""
    robot = robot_of(arm_model(4))
    stuck = plan_faults((JointStuck(joint="joint_2", at=0.5),), FaultSite(robot), period=PERIOD, steps=20, seed=0)
    with pytest.raises(SpecError) as caught:
        plant_of({"joints": GEARS}, robot, braked=what == "brakes", faults=stuck if what == "stuck" else None)
    assert caught.value.key == key


@pytest.mark.parametrize("kernel", KERNELS)
def test_joints_that_follow_others_compose(kernel: Kernel) -> None:
    """Panels, fuel and gears on a robot with followers: the spring is on the coordinate."""
    robot = robot_of(random_coupled(np.random.default_rng(6), 6, serial=True).model)
    panel = PANEL | {"mass": 2.0, "inertia": [0.9, 0.15, 1.0], "com": [0.0, 0.2, 0.0]}
    flexibility = {"appendages": [panel | {"added": True}], "joints": GEARS}
    state = random_state(np.random.default_rng(1), robot.n, 0.05)
    plant = plant_of(flexibility, robot, kernel, state=state)
    assert worst_residual(simulate(plant, 10, 0.2, robot.n)) < 1e-9
