"""Channels of a law have one name each, whatever the joints of the robot are called."""

from __future__ import annotations

import numpy as np
import pytest

from space_robot_control.channels import Channels
from space_robot_description.load import load_robot
from space_robot_description.robot import Robot
from space_robot_msgs_py.errors import SpecError
from tests.support.description_texts import TWO_LINKS, joint, robot_file, urdf


@pytest.fixture
def robot() -> Robot:
    parts = (*TWO_LINKS[:3], joint("roll", "base_link", "upper"), joint("x", "upper", "fore"))
    return load_robot(robot_file(urdf(*parts)))


def test_joints_named_as_axes_of_the_base_are_channels_of_their_own(robot: Robot) -> None:
    """A joint ``roll`` is channel ``joint.roll``; ``roll`` is the base, and each drives its own coordinate."""
    channels = Channels(robot)
    assert channels.names == ("roll", "pitch", "yaw", "joint.roll", "joint.x")
    np.testing.assert_array_equal(np.flatnonzero(channels.spread(np.array([0, 0, 0, 1.0, 0]))), [6])
    chosen = Channels(robot, ["joint.x", "roll"])
    np.testing.assert_array_equal(chosen.index, [7, 3])
    np.testing.assert_array_equal(chosen.limits(), [5.0, 1.0])


def test_such_joints_are_held_by_their_channel(robot: Robot) -> None:
    """What is held is named as what is controlled, and the plain name is not one of the joints."""
    assert Channels(robot, held=["joint.roll"]).names == ("roll", "pitch", "yaw", "joint.x")
    with pytest.raises(SpecError, match=r"held: cannot be used; got 'roll'; accepted: joint\.roll"):
        Channels(robot, held=["roll"])
