"""The examples of docs/robots.md are what they claim to be."""

from __future__ import annotations

import re

import numpy as np

from space_robot_description.dispersion import Dispersion, disperse
from space_robot_description.load import load_robot
from space_robot_description.payload import Payload, attach_payload
from space_robot_description.validation import parse_yaml_text, validate
from tests.support.paths import ROOT

TEXT = (ROOT / "docs" / "robots.md").read_text(encoding="utf-8")
TORQUE = {"kind": "thrusters", "limit": [20, 20, 20]}
ROBOT_FILE, ARMS, MODEL_FILE = re.findall(r"```yaml\n(.*?)```", TEXT, re.DOTALL)


def test_the_robot_file_of_the_docs_loads() -> None:
    """The robot file to copy is a robot with what its comments say."""
    robot = load_robot(parse_yaml_text(ROBOT_FILE, "docs"))
    assert robot.n == 5
    assert dict(zip(robot.joint_names, robot.effort_limit.tolist(), strict=True))["wrist_1_joint"] == 20.0
    assert dict(zip(robot.joint_names, robot.effort_limit.tolist(), strict=True))["elbow_joint"] == 150.0
    assert "arm_base_link" in robot.urdf


def test_the_arms_of_the_docs_stand_on_one_satellite() -> None:
    """The sections to copy make a robot of two arms that are the reader's own, here the servicing arm twice."""
    text = ARMS.replace("my_arm.urdf", str(ROOT / "config/robots/servicing_arm.urdf")).replace("hand", "link7")
    rest = {"name": "two_arms", "description": "two arms", "base_mode": "free_floating"}
    robot = load_robot(parse_yaml_text(text, "docs") | rest | {"actuators": {"joints": {}, "base_torque": TORQUE}})
    assert robot.n == 14
    assert robot.tools == {"left": "left_tool", "right": "right_link7", "camera": "left_link4"}


def test_payload_and_dispersion_of_the_docs_work() -> None:
    """The payload and dispersion to copy fit mini."""
    data = parse_yaml_text(MODEL_FILE, "docs")
    robot = attach_payload(load_robot("mini"), validate(Payload, data["payload"], "docs payload"))
    drawn = disperse(robot, validate(Dispersion, data["dispersion"], "docs dispersion"), np.random.default_rng(1))
    assert drawn.model.inertias[5].mass != robot.model.inertias[5].mass
    assert robot.model.inertias[5].mass == 22.0
