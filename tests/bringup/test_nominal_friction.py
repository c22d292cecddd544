"""Friction that laws know (``nominal.friction``): what it mends, and what it leaves as it was."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from space_robot_bringup.compose.composition import Composition, compose
from space_robot_bringup.experiment.experiment import experiment_from, to_yaml
from space_robot_bringup.fused.run import compiled_run
from space_robot_bringup.modes.headless import run_in_memory
from space_robot_control.laws.adaptive.law import Adaptive
from space_robot_control.laws.registry import BUILT_IN
from space_robot_control.nominal_friction import NominalFriction
from space_robot_description.load import load_robot
from space_robot_msgs_py.interfaces import Reference, RobotState, Vector

KNOWN = {"friction": True}
FOLLOW_NOTHING = {"damped_hold", "detumble", "none", "park"}
MOVE = {"kind": "quintic", "duration": 8.0, "joints_by_deg": 20.0}


def composed(law: str, robot: str = "mini", seconds: float = 10.0, **parts: Any) -> Composition:
    """A move of all joints of a robot with friction."""
    content = dict(load_robot(robot).resolved)
    joints = {**content["actuators"]["joints"], "viscous": 0.1, "coulomb": 0.02}
    content["actuators"] = {**content["actuators"], "joints": joints}
    data = {"robot": content, "control_period": 0.1, "duration": seconds, "reference": MOVE}
    return compose(experiment_from({**data, "controller": {"law": law}, **parts}, "test"))


def off(composition: Composition) -> Vector:
    """(n,) how far the joints are off at the end [deg]."""
    last = run_in_memory(composition).ticks[-1]
    return np.degrees(np.abs(last.reference.q[7:] - last.sample.state.q[7:]))


def test_joints_that_friction_keeps_behind_arrive() -> None:
    """Wrists of an arm that end 15 deg off and more under friction the law does not know end on their target."""
    assert np.max(off(composed("computed_torque", "ur5_sat"))[3:]) > 15.0
    assert np.max(off(composed("computed_torque", "ur5_sat", nominal=KNOWN))) < 0.2


def test_the_plant_s_own_equation_is_what_is_added() -> None:
    """Viscous and Coulomb part, at the desired rates, of nothing but the joints."""
    robot = composed("none").nominal
    friction, rates = NominalFriction(robot, known=True), np.linspace(-0.01, 0.01, robot.n)
    v = np.concatenate([np.ones(6), rates])
    reference = Reference(0, np.array([0, 0, 0, 0, 0, 0, 1.0, *robot.home]), v, np.zeros(v.size))
    added = friction.added(np.ones(v.size), reference) - 1.0
    assert added[:6].tolist() == [0.0] * 6
    np.testing.assert_allclose(added[6:], 0.1 * rates + 0.02 * np.tanh(rates / 1e-3), atol=1e-15)
    assert friction.added(np.ones(3), reference).tolist() == [1.0] * 3  # the law refuses it, with its own words


@pytest.mark.parametrize("name", BUILT_IN)
def test_all_laws_that_follow_a_reference_add_the_same(name: str) -> None:
    """The command with friction known is the one without, plus the friction at the desired rates, at any state."""
    plain, knowing = composed(name), composed(name, nominal=KNOWN)
    source, n = plain.reference(), plain.nominal.n
    reference = source.at(4 * 10**9)
    q, v = plain.initial
    state = RobotState(reference.stamp, q, v, np.zeros(n), np.zeros(3))
    first, second = (one.controller().update(state, reference).command.u for one in (plain, knowing))
    expected = NominalFriction(plain.nominal, known=name not in FOLLOW_NOTHING).added(first, reference)
    assert second.tolist() == expected.tolist()
    assert (first.tolist() != second.tolist()) == (name not in FOLLOW_NOTHING)


def test_least_squares_do_not_take_friction_for_inertia() -> None:
    """The estimate of `adaptive` stays near the truth where the friction is known, and goes far where it is not."""
    found = []
    for nominal in ({}, KNOWN):
        composition = composed("adaptive", seconds=6.0, nominal=nominal)
        law = composition.controller()
        assert isinstance(law, Adaptive)
        prior = law.regressor.parameters
        last = run_in_memory(composition).ticks[-1].output.telemetry["parameters"]
        found.append(float(np.linalg.norm(last - prior) / np.linalg.norm(prior)))
    assert found[1] < 0.1 * found[0]


def test_what_does_not_ask_for_it_is_as_before() -> None:
    """Without the key the resolved experiment has no word of it; with it a run is the loop's, not a compiled one."""
    assert (
        "friction"
        not in to_yaml(composed("computed_torque", nominal={"friction": False}).experiment).split("nominal:")[1]
    )
    assert "friction: true" in to_yaml(composed("computed_torque", nominal=KNOWN).experiment)
    assert compiled_run(composed("computed_torque", nominal=KNOWN), 3) is None
