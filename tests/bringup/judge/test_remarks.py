"""Remarks on a run: what counts as worth one, from when on, for how long, and of which joint or wheel."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from space_robot_bringup.judge.remarks import TUMBLING, Remarks
from space_robot_description.load import load_robot
from space_robot_msgs_py.interfaces import Vector
from tests.support.robots import random_model, robot_of

MINI = load_robot("mini")
PERIOD = 250_000_000
TICKS = 12


def quiet() -> dict[str, Vector]:
    """The blocks of a run of which nothing is to be said, of a robot with four joints and three wheels."""
    return {
        "joint_limit": np.zeros((TICKS, 4)),
        "wheel_momentum": np.full((TICKS, 3), 1.9),
        "command_stamp": (np.arange(TICKS)[:, None] - 1.0) * PERIOD,
        "true_velocity": np.zeros((TICKS, 10)),
    }


def remarked(
    plant: dict[str, Vector], cut: int = TICKS, delay: int = 0, robot: Any = MINI
) -> dict[str, tuple[str, int]]:
    """What is said of them, taken in blocks of so many ticks, by name: text and stamp."""
    remarks = Remarks(robot, PERIOD, delay)
    v_d = np.full((TICKS, 6 + robot.n), 0.1)
    for first in range(0, TICKS, cut):
        part = slice(first, first + cut)
        stamps = np.arange(TICKS, dtype=np.int64)[part] * PERIOD
        remarks.add(stamps, {label: block[part] for label, block in plant.items()}, v_d[part])
    for remark in remarks.found():
        assert remark.line == f"{remark.name}: {remark.text}"
    return {remark.name: (remark.text, remark.since) for remark in remarks.found()}


@pytest.mark.parametrize("cut", [1, 5, TICKS])
def test_joints_and_wheels_are_named_with_their_largest_number(cut: int) -> None:
    """Which one, how much, for how long in all and from when on, whatever the blocks the ticks come in."""
    plant = quiet()
    plant["joint_limit"][3, 1], plant["joint_limit"][7, 2], plant["joint_limit"][8, 1] = 0.01, -0.25, 0.02
    plant["wheel_momentum"][5:9, 2], plant["wheel_momentum"][10, 0] = -2.0, 2.0 * (1.0 - 1e-6)
    assert remarked(plant, cut) == {
        "joint limits": (
            "joint3 was up to 0.25 rad outside of them, for 0.75 s in all, first at 0.75 s (tick 3)",
            3 * PERIOD,
        ),
        "wheels full": (
            "wheel 2 (from 0) held up to 2 N m s of 2, for 1 s in all, first at 1.25 s (tick 5)",
            5 * PERIOD,
        ),
    }


@pytest.mark.parametrize("cut", [1, TICKS])
def test_of_equal_numbers_the_first_is_named(cut: int) -> None:
    """Whatever the blocks; and where there is nothing that could be beyond, nothing is said."""
    plant = quiet()
    plant["joint_limit"][2, 3], plant["joint_limit"][5, 0] = 0.5, -0.5
    assert remarked(plant, cut)["joint limits"][0].startswith("joint4 was up to 0.5 rad")
    assert remarked({"joint_limit": np.zeros((TICKS, 0)), "wheel_momentum": np.zeros((TICKS, 0))}, cut) == {}


def test_a_joint_that_slides_is_outside_by_metres() -> None:
    """The unit is that of the joint."""
    robot = robot_of(random_model(np.random.default_rng(0), 4, kinds=("PX",)))
    plant = {"joint_limit": np.zeros((TICKS, 4))}
    plant["joint_limit"][0, 3] = 0.125
    text, since = remarked(plant, robot=robot)["joint limits"]
    assert (text, since) == ("joint_3 was up to 0.125 m outside of them, for 0.25 s in all, first at 0 s (tick 0)", 0)


@pytest.mark.parametrize("cut", [1, 5, TICKS])
@pytest.mark.parametrize("delay", [0, 1])
def test_a_command_that_did_not_act_is_missed(cut: int, delay: int) -> None:
    """Delayed ones are expected so much later; before the first can act none is missed."""
    plant = quiet()
    answers = plant["command_stamp"] - delay * PERIOD
    answers[: 1 + delay] = -1.0
    plant["command_stamp"] = answers
    assert remarked(plant, cut, delay) == {}
    # The answer to state 0 is the first that can be missed.
    answers[1 + delay] = -1.0
    assert remarked(plant, cut, delay)["missed commands"][1] == (1 + delay) * PERIOD
    answers[1 + delay] = 0.0
    answers[4] = -1.0
    text = "no answer to the state acted in one period, first at 1 s (tick 4)"
    assert remarked(plant, cut, delay) == {"missed commands": (text, 4 * PERIOD)}
    answers[9] = 2.0 * PERIOD
    text = "no answer to the state acted in 2 periods, first at 1 s (tick 4)"
    assert remarked(plant, cut, delay) == {"missed commands": (text, 4 * PERIOD)}


@pytest.mark.parametrize("cut", [1, 5, TICKS])
def test_a_base_that_turns_beside_its_reference_tumbles(cut: int) -> None:
    """Faster than desired by more than the bound for a second in all, with its largest excess; shorter is nothing."""
    plant = quiet()
    plant["true_velocity"][:, 3:6] = 0.1
    plant["true_velocity"][4:7, 3] += TUMBLING + 0.01
    assert remarked(plant, cut) == {}
    plant["true_velocity"][9, 5] -= 0.5
    text = "the base turned up to 0.5 rad/s faster than was desired, above 0.3 for 1 s in all, first at 1 s (tick 4)"
    assert remarked(plant, cut) == {"tumbling": (text, 4 * PERIOD)}
    plant["true_velocity"][4:7, 3] -= 0.01
    plant["true_velocity"][4:7, 3] -= 1e-9
    assert remarked(plant, cut) == {}


def test_of_what_is_not_in_the_log_nothing_is_said() -> None:
    """Other plants have other blocks; what is there is remarked on in one order."""
    plant = quiet()
    plant["joint_limit"][2], plant["wheel_momentum"][2], plant["command_stamp"][2] = 0.1, 2.0, -1.0
    plant["true_velocity"][:, 3] = 9.0
    names = ["joint limits", "wheels full", "missed commands", "tumbling"]
    assert list(remarked(plant)) == names
    for label, name in zip(quiet(), names, strict=True):
        assert list(remarked({other: block for other, block in plant.items() if other != label})) == [
            other for other in names if other != name
        ]
    assert remarked({}) == {}
