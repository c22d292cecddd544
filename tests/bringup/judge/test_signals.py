"""Signals that an experiment may expect something of: each is its formula, in its unit."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from space_robot_bringup.judge.signals import Rows, signals_of
from space_robot_description.load import load_robot
from space_robot_description.robot import Robot
from space_robot_msgs_py.errors import LayoutError
from space_robot_msgs_py.interfaces import Vector
from tests.support.robots import random_model, robot_of

ROBOTS = {name: load_robot(name) for name in ("mini", "servicer")}
TICKS = 6


def random_rows(robot: Robot, seed: int) -> Rows:
    """Any motion, and any other one that was desired."""
    rng, n = np.random.default_rng(seed), robot.n
    q, q_d = rng.normal(size=(2, TICKS, 7 + n))
    for one in (q, q_d):
        one[:, 3:7] /= np.linalg.norm(one[:, 3:7], axis=1, keepdims=True)
    plant = {
        "true_configuration": q,
        "true_velocity": rng.normal(size=(TICKS, 6 + n)),
        "joint_limit": rng.normal(size=(TICKS, n)),
        "wheel_momentum": rng.normal(size=(TICKS, 3)),
    }
    return Rows(plant, q_d, rng.normal(size=(TICKS, 6 + n)))


def formulas(robot: Robot, rows: Rows) -> dict[str, Vector]:
    """The same, tick by tick."""
    q, v, q_d = rows.plant["true_configuration"], rows.plant["true_velocity"], rows.q_d
    turn = Rotation.from_quat(q_d[:, 3:7]).inv() * Rotation.from_quat(q[:, 3:7])
    found: dict[str, Vector] = {
        "base.rate": np.linalg.norm(v[:, 3:6], axis=1),
        "base.speed": np.linalg.norm(v[:, :3], axis=1),
        "joints.rate": np.abs(v[:, 6:]).max(axis=1),
        "error.position": np.linalg.norm(q[:, :3] - q_d[:, :3], axis=1),
        "error.attitude": turn.magnitude(),
        "error.joints": np.abs(q[:, 7:] - q_d[:, 7:]).max(axis=1),
        "joints.beyond": np.abs(rows.plant["joint_limit"]).max(axis=1),
    }
    torque = robot.actuators.base_torque
    if torque.kind == "reaction_wheels":
        found["wheels.load"] = np.abs(rows.plant["wheel_momentum"]).max(axis=1) / torque.momentum
    parts = {"position": (q, 0, "xyz"), "rate": (v, 3, "xyz")}
    parts |= {"joint.position": (q, 7, robot.joint_names), "joint.rate": (v, 6, robot.joint_names)}
    for part, (block, first, names) in parts.items():
        found |= {f"{part}.{name}": block[:, first + index] for index, name in enumerate(names)}
    return found


@pytest.mark.parametrize("robot", ROBOTS.values(), ids=ROBOTS)
def test_every_signal_is_its_formula(robot: Robot) -> None:
    """There are no others, and in random motions each is what its name says."""
    rows = random_rows(robot, 3)
    expected, signals = formulas(robot, rows), signals_of(robot)
    assert signals.keys() == expected.keys()
    for name, signal in signals.items():
        np.testing.assert_allclose(signal.read(rows), expected[name], atol=1e-14, err_msg=name)


@pytest.mark.parametrize(
    ("kinds", "joints", "all_of_them"),
    [(("RX",), 6, "rad"), (("PX",), 6, "m"), (("PX",), 1, "m"), (("RX", "PX", "PY"), 6, "rad or m")],
)
def test_units_are_those_of_the_joints(kinds: tuple[str, ...], joints: int, all_of_them: str) -> None:
    """A joint that slides is in metres; a number over joints of both kinds says both."""
    model = random_model(np.random.default_rng(4), joints, kinds=kinds)
    robot = robot_of(model)
    units = {name: signal.unit for name, signal in signals_of(robot).items()}
    assert len(set(robot.prismatic)) == len({kind[0] for kind in kinds})
    for name, prismatic in zip(robot.joint_names, robot.prismatic, strict=True):
        unit = "m" if prismatic else "rad"
        assert (units[f"joint.position.{name}"], units[f"joint.rate.{name}"]) == (unit, f"{unit}/s")
    for name in ("error.joints", "joints.beyond"):
        assert units[name] == all_of_them
    assert units["joints.rate"] == f"{all_of_them}/s"
    base = {"base.rate": "rad/s", "base.speed": "m/s", "error.position": "m", "error.attitude": "rad"}
    base |= {"position.x": "m", "rate.z": "rad/s"}
    assert signals_of(ROBOTS["mini"])["wheels.load"].unit == "of their capacity"
    assert {name: units[name] for name in base} == base


def test_of_a_robot_without_joints_none_is_fast_off_or_beyond() -> None:
    """There is no largest of none: it is 0."""
    robot = robot_of(random_model(np.random.default_rng(5), 0))
    rows, signals = random_rows(robot, 6), signals_of(robot)
    for name in ("joints.rate", "error.joints", "joints.beyond"):
        np.testing.assert_array_equal(signals[name].read(rows), np.zeros(TICKS))


def test_a_block_that_is_not_there_is_named() -> None:
    """With those that are."""
    robot = ROBOTS["mini"]
    rows = Rows({"energy": np.zeros((1, 1)), "momentum": np.zeros((1, 6))}, np.zeros((1, 11)), np.zeros((1, 10)))
    with pytest.raises(LayoutError, match=r"no such block; got 'true_velocity'; accepted: energy, momentum"):
        signals_of(robot)["base.rate"].read(rows)
