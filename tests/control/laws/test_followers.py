"""Joints that follow others are bodies as well: what compiled laws work in has room for them."""

from __future__ import annotations

import pytest

from space_robot_control.laws.lqr.law import Lqr
from space_robot_control.laws.mpc.law import LinearMpc
from space_robot_control.laws.rates_to_zero import RatesToZero
from space_robot_control.laws.reaction_null_space.law import ReactionNullSpace
from space_robot_control.laws.registry import make_law
from space_robot_description.load import load_robot


@pytest.mark.parametrize("name", ["damped_hold", "detumble", "park", "lqr", "mpc", "reaction_null_space"])
def test_there_is_room_for_every_body(name: str) -> None:
    """Compiled code checks no index: a row too few is a write into the memory of something else."""
    robot = load_robot("panda_gripper")
    law = make_law(name, robot, 0.1)
    if isinstance(law, RatesToZero):
        work, bodies = law.room.work, len(law.known.robot.links)
    else:
        assert isinstance(law, Lqr | LinearMpc | ReactionNullSpace)
        work, bodies = law._memory.work, len(law.model.arrays.links)
    assert len(work.bodies) == bodies == 1 + robot.n + len(robot.mimics)
