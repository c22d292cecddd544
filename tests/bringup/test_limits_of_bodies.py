"""Plant and laws take what is no body by itself: a link without mass between two axes, and a point at the end."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from space_robot_bringup.compose.composition import compose_world
from space_robot_bringup.experiment.experiment import experiment_from
from space_robot_bringup.modes.run import run_experiment
from space_robot_control.laws.policy import TYPED
from space_robot_description.payload import Payload, attach_payload
from space_robot_msgs_py.interfaces import Command
from tests.support.description_texts import joint, link, robot_file, urdf

BASE = '<inertial><mass value="50"/><inertia ixx="3" iyy="4" izz="5"/></inertial>'
POINT = '<inertial><origin xyz="0.3 0.1 0.1"/><mass value="2"/></inertial>'
CROSSED = '<axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="7" velocity="3"/>'
PARTS = (link("base_link", BASE), link("cross", ""), link("fore", POINT))
ROBOT = urdf(*PARTS, joint("j1", "base_link", "cross"), joint("j2", "cross", "fore", inside=CROSSED))


def _experiment(law: str, **changes: Any) -> Any:
    data: dict[str, Any] = {"robot": robot_file(ROBOT), "control_period": 0.1, "duration": 3.0}
    data["reference"] = {"kind": "quintic", "duration": 2.0, "joints": [0.2, 0.1]}
    return experiment_from(data | {"controller": {"law": law}} | changes, "test")


@pytest.mark.parametrize("law", ["computed_torque", "adaptive", "ntsmc", "mfac", "pd"])
def test_every_law_moves_points_and_massless_links(law: str, tmp_path: Any) -> None:
    """A run completes, and momentum and energy stay balanced."""
    result = run_experiment(_experiment(law), tmp_path / "bag", mode="headless")
    assert result.end_reason == "completed"
    assert result.metrics is not None
    assert result.metrics.flat()["momentum_residual"] < 1e-12
    assert result.metrics.flat()["energy_residual"] < 1e-9


def test_the_plant_accelerates_them_as_pinocchio_does() -> None:
    """The compiled plant and the articulated-body algorithm of Pinocchio find the same motion over one period."""
    composition = compose_world(_experiment("pd"), TYPED)
    plant = composition.plant()
    state, model = plant.reset().state, composition.truth.model
    efforts = np.array([0.4, -0.3])
    command = Command(state.stamp, np.zeros(6), efforts)
    after = plant.step(command).state
    acceleration = pin.aba(model, model.createData(), state.q, state.v, np.concatenate([np.zeros(6), efforts]))
    np.testing.assert_allclose((after.v - state.v)[6:] / 0.1, acceleration[6:], rtol=0.02)


def test_a_payload_is_held_by_a_link_without_mass() -> None:
    """What is attached to a massless link is all of its mass."""
    robot = compose_world(_experiment("pd"), TYPED).truth
    laden = attach_payload(robot, Payload(mass=3.0, com=(0.1, 0.0, 0.0), frame="cross"))
    assert laden.model.inertias[2].mass == 3.0
    np.testing.assert_allclose(laden.model.inertias[2].lever, [0.1, 0.0, 0.0], atol=1e-15)
