"""The layouts for Foxglove, PlotJuggler and RViz name only what a log has."""

from __future__ import annotations

import json
import re
from typing import Any
from xml.etree import ElementTree

import pytest
from rosbags.highlevel import AnyReader
from ruamel.yaml import YAML

from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.run import run_experiment
from space_robot_description.share import config_dir

FOXGLOVE = json.loads((config_dir() / "foxglove" / "space_robot.json").read_text(encoding="utf-8"))
PLOTJUGGLER = ElementTree.parse(config_dir() / "plotjuggler" / "space_robot.xml").getroot()
RVIZ = YAML(typ="safe").load(config_dir() / "rviz" / "space_robot.rviz")
RVIZ_TYPES = {
    "RobotModel": "std_msgs/msg/String",
    "Odometry": "nav_msgs/msg/Odometry",
    "Wrench": "geometry_msgs/msg/WrenchStamped",
}


@pytest.fixture(scope="module")
def last(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """The last message of every topic of a log, as another reader decodes it."""
    bag = tmp_path_factory.mktemp("bags") / "fig08"
    faulty = "faults=[{kind: joint_stuck, joint: joint1, at: 0.5}]"
    supervised = ["duration=1.0", "expect={}", "supervision=mini_basic", faulty]
    run_experiment(load_experiment("liu2023/fig08", supervised), bag, mode="headless")
    with AnyReader([bag]) as reader:
        found = {
            connection.topic: (connection.msgtype, reader.deserialize(raw, connection.msgtype))
            for connection, _, raw in reader.messages()
        }
    # What a supervisor finds is not in every run, and looks like the faults.
    return {"/events": found["/faults"], **found}


def split(path: str, last: dict[str, Any], separator: str) -> tuple[Any, list[str]]:
    """The message of the longest topic a path begins with, and the steps into it."""
    topic = max((name for name in last if path.startswith((f"{name}{separator}", name))), key=len, default=None)
    assert topic is not None, f"{path}: no such topic"
    return last[topic][1], [step for step in path[len(topic) :].split(separator) if step]


def walk(value: Any, steps: list[str]) -> Any:
    """Fields, ``[i]`` and ``[a:b]`` one after the other."""
    for step in steps:
        name, *brackets = re.findall(r"[^\[\]]+", step)
        value = getattr(value, name)
        for bracket in brackets:
            ends = [int(end) if end else None for end in bracket.split(":")]
            value = value[ends[0]] if len(ends) == 1 else value[slice(*ends)]
    return value


def foxglove_paths() -> list[str]:
    panels = FOXGLOVE["configById"].values()
    return [path["value"] for panel in panels for path in panel.get("paths", ())]


# A path as Lichtblick reads it: a topic, fields and indices, at the very end one modifier at most. Foxglove takes more.
LICHTBLICK = re.compile(r"(/\w+)+(\.\w+|\[-?\d*(:-?\d*)?\])*(\.@\w+)?")


@pytest.mark.parametrize("path", foxglove_paths())
def test_every_path_is_one_that_lichtblick_reads(path: str) -> None:
    """The one layout is for both: a chain of modifiers, which Foxglove has and Lichtblick refuses, is not in it."""
    assert LICHTBLICK.fullmatch(path), path


def test_a_chain_of_modifiers_is_none_of_the_grammar() -> None:
    """The paths that the layout had before are refused, those with one modifier are not."""
    assert not LICHTBLICK.fullmatch("/base/odom.pose.pose.orientation.@rpy.roll.@degrees")
    assert LICHTBLICK.fullmatch("/joint_states.position[:].@rad2deg")


@pytest.mark.parametrize("path", foxglove_paths())
def test_foxglove_plots_what_is_there(last: dict[str, Any], path: str) -> None:
    """Every message path of the Foxglove layout leads to numbers."""
    value = walk(*split(path, last, "."))
    assert len(value) > 0 if hasattr(value, "__len__") else isinstance(value, float)


def test_foxglove_shows_topics_and_panels_that_are_there(last: dict[str, Any]) -> None:
    """The robot comes from a topic of the log, its frames are those of /tf, and the layout places every panel once."""
    panel = FOXGLOVE["configById"]["3D!robot"]
    assert {panel["layers"]["robot"]["topic"], *panel["topics"]} <= last.keys()
    raw = [config["topicPath"] for name, config in FOXGLOVE["configById"].items() if name.startswith("RawMessages")]
    assert set(raw) <= last.keys()
    frames = {t.child_frame_id for topic in ("/tf", "/tf_static") for t in last[topic][1].transforms} | {"inertial"}
    assert {panel["followTf"], panel["layers"]["grid"]["frameId"]} <= frames
    placed: list[str] = []

    def gather(node: Any) -> None:
        if isinstance(node, str):
            placed.append(node)
        else:
            gather(node["first"])
            gather(node["second"])

    gather(FOXGLOVE["layout"])
    assert sorted(placed) == sorted(FOXGLOVE["configById"])


@pytest.mark.parametrize("name", [curve.get("name") for curve in PLOTJUGGLER.iter("curve")])
def test_plotjuggler_plots_what_is_there(last: dict[str, Any], name: str) -> None:
    """Every curve of the PlotJuggler layout is a series that its parser makes of our topics, in any version.

    It names joints instead of numbering them. What it makes of quaternions is called otherwise, and in other units,
    from version 3.9 on: the layout has none of that.
    """
    message, steps = split(name, last, "/")
    if hasattr(message, "effort"):
        joint, field = steps
        assert len(getattr(message, field)) > message.name.index(joint)
        return
    assert isinstance(walk(message, steps), float)


def test_rviz_shows_what_is_there(last: dict[str, Any]) -> None:
    """Every display of the RViz configuration has a topic of the right type, in a fixed frame of /tf."""
    manager = RVIZ["Visualization Manager"]
    shown = 0
    for display in manager["Displays"]:
        topic = display.get("Topic") or display.get("Description Topic")
        if topic is not None:
            assert last[topic["Value"]][0] == RVIZ_TYPES[display["Class"].split("/")[1]]
            shown += 1
    assert shown == 4
    assert manager["Global Options"]["Fixed Frame"] == last["/tf"][1].transforms[0].header.frame_id
