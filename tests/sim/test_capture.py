"""A free body is caught: momentum, energy and rates through the impact, and what a file may say of it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.headless import run_in_memory
from space_robot_description.payload import Payload, attach_payload
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import PlantSample
from space_robot_sim.capture import RobotChange, TargetSpec, catch, free_body
from space_robot_sim.plant import InitialState, SimulatedRobot
from space_robot_sim.spec import IntegratorSpec
from space_robot_studies.campaign.spec import load_campaign
from tests.support.robots import arm_model, random_state, robot_of

PERIOD = 100_000_000
BODY: dict[str, Any] = {"mass": 20.0, "inertia": [0.9, 1.4, 1.1], "com": [0.1, -0.2, 0.3], "frame": "hand"}
TUMBLING: dict[str, Any] = {"linear_velocity": [0.02, -0.01, 0.03], "angular_velocity": [0.05, 0.1, -0.02]}
LAWS: Any = load_campaign("capture_mini").vary["controller"]
WHEELS = {"base_torque": {"kind": "reaction_wheels", "torque": 2.0, "momentum": 50.0, "initial_momentum": (1, 2, -3)}}


def arm() -> Any:
    """The seven-joint arm with a hand."""
    model = arm_model()
    model.addFrame(pin.Frame("hand", 8, 0, pin.SE3.Identity(), pin.FrameType.BODY))
    return model


def target(**keys: Any) -> TargetSpec:
    return TargetSpec.model_validate({"payload": Payload.model_validate(BODY)} | keys)


def coasting(spec: TargetSpec, *, speed: float = 0.05, kernel: Any = "auto", after: int = 3) -> list[PlantSample]:
    """Ten periods of a robot that coasts and catches a body after some of them."""
    robot = robot_of(arm(), WHEELS, floating=True)
    change = RobotChange(after * PERIOD, attach_payload(robot, spec.payload), free_body(robot, spec))
    initial = InitialState(*random_state(np.random.default_rng(0), 7, speed))
    plant = SimulatedRobot(
        robot, control_period=PERIOD, initial=initial, changes=[change], integrator=IntegratorSpec(kernel=kernel)
    )
    return [plant.reset(), *(plant.step(None) for _ in range(10))]


def jump(samples: list[PlantSample], label: str, after: int = 3) -> Any:
    return samples[after + 1].telemetry[label] - samples[after].telemetry[label]


def test_momentum_changes_by_what_the_target_brings() -> None:
    """Linear momentum gains m v, angular momentum c x m v + I omega of the target, wheels included, no more."""
    spec = target(**TUMBLING)
    samples = coasting(spec)
    robot, q = robot_of(arm()), np.array(samples[3].telemetry["true_configuration"])
    data = robot.model.createData()
    pin.forwardKinematics(robot.model, data, q)
    hand, v, omega = data.oMi[8], np.array(spec.linear_velocity), np.array(spec.angular_velocity)
    centre = hand.act(np.array(BODY["com"]))
    spin = hand.rotation @ np.diag(BODY["inertia"]) @ hand.rotation.T @ omega
    brought = [*(20.0 * v), *(np.cross(centre, 20.0 * v) + spin)]
    np.testing.assert_allclose(jump(samples, "momentum"), brought, atol=1e-11)


@pytest.mark.parametrize("kernel", ["auto", "pinocchio"])
@pytest.mark.parametrize("motion", [{}, TUMBLING])
def test_the_balance_goes_on_through_the_impact(kernel: str, motion: dict[str, Any]) -> None:
    """Momentum and energy of robot and target before, and of both after it, agree but for the work of the impact."""
    samples = coasting(target(**motion), kernel=kernel)
    for sample in samples:
        assert sample.telemetry["momentum_residual"].max() < 1e-12
        assert sample.telemetry["energy_residual"].max() < 1e-12


def test_a_system_at_rest_stays_at_rest() -> None:
    """A robot at rest that takes a body at rest does not move."""
    samples = coasting(target(), speed=0.0)
    assert not samples[-1].telemetry["true_velocity"].any()


def test_a_body_at_rest_slows_the_hand() -> None:
    """Total momentum does not change where the target has none: the body does not appear at the hand's velocity."""
    samples = coasting(target())
    np.testing.assert_allclose(jump(samples, "momentum"), 0.0, atol=1e-12)
    assert np.abs(jump(samples, "true_velocity")).max() > 1e-3


def test_an_attached_body_appears_at_the_velocity_of_the_hand() -> None:
    """With `attached: true` no rate jumps, momentum does, and the conservation baseline is reset."""
    samples = coasting(target(attached=True))
    assert np.linalg.norm(jump(samples, "momentum")) > 0.1
    assert max(sample.telemetry["momentum_residual"].max() for sample in samples) < 1e-12


def test_the_impact_is_that_of_the_impulse_between_both_bodies() -> None:
    """v+ = v + M^-1 J^T (J M^-1 J^T + I^-1)^-1 (v_t - J v), hand and target move as one, and energy is lost."""
    robot, spec = robot_of(arm()), target(**TUMBLING)
    q, v = random_state(np.random.default_rng(3), 7, 0.3)
    body, laden = free_body(robot, spec), attach_payload(robot, spec.payload)
    assert body is not None
    impact = catch(laden.model, q, v, body)
    after = impact.velocity

    model, data = robot.model, robot.model.createData()
    pin.computeAllTerms(model, data, q, v)
    mass = np.triu(data.M) + np.triu(data.M, 1).T
    jacobian = pin.getJointJacobian(model, data, 8, pin.LOCAL_WORLD_ALIGNED)
    to_world = pin.SE3(data.oMi[8].rotation, np.zeros(3))
    spatial = to_world.act(body.inertia).matrix()
    lever = data.oMi[8].rotation @ np.array(BODY["com"])
    linear = np.array(spec.linear_velocity) - np.cross(spec.angular_velocity, lever)
    twist = np.concatenate([linear, spec.angular_velocity])
    yielding = jacobian @ np.linalg.solve(mass, jacobian.T) + np.linalg.inv(spatial)
    impulse = np.linalg.solve(yielding, twist - jacobian @ v)
    np.testing.assert_allclose(after, v + np.linalg.solve(mass, jacobian.T @ impulse), atol=1e-13)
    np.testing.assert_allclose(spatial @ (twist - jacobian @ after), impulse, atol=1e-12)
    both = mass + jacobian.T @ spatial @ jacobian
    assert impact.energy == pytest.approx(0.5 * twist @ spatial @ twist)
    assert impact.work == pytest.approx(0.5 * (after @ both @ after - v @ mass @ v) - impact.energy)
    assert impact.work < 0.0


def test_a_point_mass_can_be_caught() -> None:
    """A target without inertia about its centre has no inverse of its spatial inertia, and momentum is conserved."""
    point = Payload(mass=3.0, frame="hand")
    samples = coasting(target(payload=point, linear_velocity=[0.1, 0.0, 0.0]))
    np.testing.assert_allclose(jump(samples, "momentum")[:3], [0.3, 0.0, 0.0], atol=1e-12)


def test_two_at_once_are_caught_as_one() -> None:
    """A capture of the plant and one by a fault at the same tick: the momentum of both is there after it."""
    payload = {"mass": 2.0, "inertia": [0.01, 0.02, 0.03]}
    fault = {"kind": "payload_captured", "payload": payload, "linear_velocity": [0.01, 0, 0], "at": 0.5}
    capture = {"time": 0.5, "payload": payload, "linear_velocity": [0, 0.01, 0]}
    spec = load_experiment("liu2023/fig08", {"duration": 2.0, "faults": [fault], "plant.capture": capture})
    plant = compose(spec).plant()
    samples = [plant.reset(), *(plant.step(None) for _ in range(8))]
    np.testing.assert_allclose(jump(samples, "momentum", 2)[:3], [0.02, 0.02, 0.0], atol=1e-12)
    assert max(sample.telemetry["momentum_residual"].max() for sample in samples) < 1e-12


def test_attached_and_a_velocity_contradict() -> None:
    """A body that appears at the velocity of the hand has none of its own."""
    capture = {"time": 1.0, "payload": BODY, "attached": True, "linear_velocity": [0.1, 0, 0]}
    with pytest.raises(SpecError, match=r"plant\.capture.*attached"):
        load_experiment("liu2023/fig08", {"plant.capture": capture})


@pytest.mark.parametrize("law", sorted(LAWS))
def test_every_law_brings_a_tumbling_body_to_rest(law: str) -> None:
    """Two minutes after the impact nothing turns faster than 0.15 deg/s, and momentum was balanced through it."""
    composition = compose(load_experiment("capture/tumbling", {"controller": LAWS[law]}))
    samples = [tick.sample for tick in run_in_memory(composition).ticks]
    assert np.abs(samples[51].telemetry["true_velocity"][3:]).max() > 0.1
    assert np.abs(samples[-1].telemetry["true_velocity"][3:]).max() < np.radians(0.15)
    assert max(sample.telemetry["momentum_residual"].max() for sample in samples) < 1e-12
