"""Robots from public tables: what a reader can look up is what the model has."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from space_robot_description.inertia import inertial_parameters
from space_robot_description.load import load_robot


def test_the_long_arm_has_the_masses_and_lengths_of_its_table() -> None:
    """Seven moving links and the latch weigh 1505.3 kg, within the spread of sources; stretched out it is 17 m long."""
    robot = load_robot("canadarm2_like")
    masses = inertial_parameters(robot)[:, 0]
    assert masses[1:].tolist() == [105.98, 105.98, 314.88, 279.2, 105.98, 105.98, 243.66]
    arm = masses.sum() - 20000.0
    assert arm == pytest.approx(1505.32)
    assert 1497.0 <= arm <= 1800.0
    data, q = robot.model.createData(), pin.neutral(robot.model)
    pin.framesForwardKinematics(robot.model, data, q)
    ends = [data.oMf[robot.model.getFrameId(name, pin.FrameType.BODY)].translation for name in ("latch", "tool")]
    assert ends[1][0] - ends[0][0] == pytest.approx(2 * 7.11 + 2 * 1.3589)
    assert 16.9 < np.linalg.norm(ends[1] - ends[0]) < 17.1


def test_the_free_flyer_has_the_numbers_of_its_table() -> None:
    """The satellite of the robot file is 9.584 kg; with its arm, of which the bay does not move, 10.27 kg."""
    robot = load_robot("astrobee_like")
    masses = inertial_parameters(robot)[:, 0]
    np.testing.assert_allclose(masses, [9.584 + 0.3078, 0.1623, 0.2178], rtol=1e-14)
    assert robot.joint_names == ("arm_proximal_joint", "arm_distal_joint")
