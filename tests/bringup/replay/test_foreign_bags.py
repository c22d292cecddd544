"""Bags that other tools wrote, with the project's topics in them: they replay, are shown and recovered like its own."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.writer import CompressionType

from space_robot_bringup.logs.foreign_bag import Source
from space_robot_bringup.logs.info import bag_info
from space_robot_bringup.replay.replay import Replayed
from space_robot_msgs_py.codec.generic import parse, serialise
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.log.recover import recover
from space_robot_msgs_py.topics import TABLE
from tests.support.foreign_bags import SHORT, TYPES, WALL, recorded, with_mcap, write
from tests.support.replays import record_run, replayed
from tests.support.tool import Tool, refused

FORMS = ("rosbags", "sqlite", "message", "file", "storage", "lz4", "zstd", "plain", "split", "namespace")


@pytest.fixture(scope="module")
def run_log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three seconds of a noisy run."""
    return record_run(tmp_path_factory.mktemp("logs") / "run", "liu2023/noise", SHORT)


def run(bag: Path, **order: Any) -> Replayed:
    return replayed(bag, experiment="liu2023/noise", overrides=[SHORT], **order)


@pytest.mark.parametrize("form", FORMS)
def test_bags_of_other_tools_replay_to_the_bit(run_log: Path, tmp_path: Path, form: str) -> None:
    """Whatever the tool, chunks, compression, split, order and padding: controller and plant are equal."""
    bag = write(form, run_log, tmp_path / "bag")
    done = run(bag, source=Source("robot1" if form == "namespace" else ""))
    assert [outcome.against for outcome in done.outcomes] == ["controller", "plant"]
    for outcome in done.outcomes:
        assert outcome.first is None
        assert outcome.absent == ()
        assert outcome.ticks == sum(1 for _ in LogReader(run_log).ticks())
    found = bag_info(bag)
    assert found.messages == sum(topic.count for topic in bag_info(run_log).topics if not topic.name.startswith("/tf"))
    assert found.damage == ()
    assert found.verdict.passed is None
    assert {
        topic.name.removeprefix("/robot1").lstrip("/"): topic.type for topic in found.topics
    }.items() <= TYPES.items()


def as_others_name(name: str, raw: bytes) -> bytes:
    """A joint message with its joints the other way round and a gripper among them, in a frame of the sender."""
    if name not in ("joint_states", "joint_command", "reference/joints"):
        return raw
    message = parse(TYPES[name], raw)
    point = message.points[0] if name == "reference/joints" else message
    fields = ("position", "velocity", "effort") if point is message else ("positions", "velocities", "accelerations")
    for field in fields:
        array = getattr(point, field)
        setattr(point, field, np.array([*array[::-1], 7.0] if len(array) else array))
    names = [*reversed(message.name if point is message else message.joint_names), "gripper"]
    setattr(message, "name" if point is message else "joint_names", names)
    message.header.frame_id = "world"
    return serialise(TYPES[name], message)


def test_joints_are_found_by_name_in_a_foreign_bag(run_log: Path, tmp_path: Path) -> None:
    """In another order, with a gripper: both sides replay equal to the bit."""
    messages = [(name, time, as_others_name(name, raw)) for name, time, raw in recorded(run_log)]
    with_mcap(tmp_path / "bag.mcap", messages, CompressionType.ZSTD)
    done = run(tmp_path / "bag.mcap")
    assert done.equal, [outcome.first for outcome in done.outcomes]
    ticks = sum(1 for _ in LogReader(run_log).ticks())
    assert [outcome.ticks for outcome in done.outcomes] == [ticks, ticks]


def test_another_gain_shows_in_a_foreign_bag_too(run_log: Path, tmp_path: Path) -> None:
    """The comparison is not for show."""
    bag = write("lz4", run_log, tmp_path / "bag")
    done = replayed(bag, experiment="liu2023/noise", overrides=[SHORT, "controller.gains.lambda=0.7"])
    assert [outcome.equal for outcome in done.outcomes] == [False, True]


def test_topics_missing_in_a_bag_come_from_the_experiment_or_are_named(run_log: Path, tmp_path: Path) -> None:
    """References are functions of time; telemetry is not compared and named; states there must be."""
    references = tuple(topic.name for topic in TABLE if topic.kind == "reference")
    bag = write("zstd", run_log, tmp_path / "bag", (*references, "controller/telemetry", "plant/telemetry"))
    done = run(bag)
    assert [outcome.equal for outcome in done.outcomes] == [True, True]
    assert [outcome.absent for outcome in done.outcomes] == [("controller/telemetry",), ("plant/telemetry",)]
    poor = write("zstd", run_log, tmp_path / "poor", ("joint_states", "joint_command"))
    with pytest.raises(OSError, match=r"nothing to compare with a controller.*joint_states"):
        run(poor)


def test_without_an_experiment_the_tool_says_what_it_needs(space_robot: Tool, run_log: Path, tmp_path: Path) -> None:
    """No header, another namespace, another period, another robot: one line each, with what would do."""
    write("zstd", run_log, tmp_path / "bag")
    write("namespace", run_log, tmp_path / "spaced")
    options = ("--experiment", "liu2023/noise", "--set", SHORT)
    refused(space_robot("replay", "bag"), "--experiment")
    refused(space_robot("replay", "spaced", *options), "none of our topics", "--namespace robot1")
    refused(
        space_robot("replay", "bag", *options, "--set", "control_period=0.5"), "control_period", "what was recorded"
    )
    refused(space_robot("replay", "bag", "--experiment", "compare/servicer"), "bag")
    assert space_robot("replay", "spaced", *options, "--namespace", "/robot1").returncode == 0
    refused(space_robot("replay", "bag", *options, "--update-refs", "--json"), "run again")


def test_info_of_a_foreign_bag(space_robot: Tool, run_log: Path, tmp_path: Path) -> None:
    """Topics, types, rates and times are those of the bag; there is no verdict without an experiment, and no NaN."""
    write("split", run_log, tmp_path / "bag")
    said = json.loads(space_robot("info", "bag", "--json").stdout)
    topics = {topic["name"]: topic for topic in said["topics"]}
    period = LogReader(run_log).arrays().time[1]
    assert topics["/base/odom"]["rate"] == pytest.approx(1.0 / period)
    assert topics["/base/odom"]["first"] == WALL
    assert said["passed"] is None
    assert "no experiment" in said["why_not"]
    assert "/base/odom" in space_robot("info", "bag").stdout


@pytest.mark.parametrize("form", ["rosbags", "lz4", "split"])
def test_foreign_bags_are_recovered(run_log: Path, tmp_path: Path, form: str) -> None:
    """Several files become one, with the names, types and times of the messages; a cut one gives its beginning."""
    bag = write(form, run_log, tmp_path / "bag")
    before = bag_info(bag)
    done = recover(bag, tmp_path / "good")
    after = bag_info(tmp_path / "good")
    assert done.damage == ()
    assert {t.name: (t.type, t.count, t.first) for t in after.topics} == {
        t.name: (t.type, t.count, t.first) for t in before.topics
    }
    assert [outcome.equal for outcome in run(tmp_path / "good").outcomes] == [True, True]
    last = sorted(bag.glob("*.mcap"))[-1]
    share = 4 if form == "split" else 2  # of a third of the messages, or of all
    last.write_bytes(last.read_bytes()[: last.stat().st_size // share])
    cut = recover(bag, tmp_path / "rest")
    assert 0 < sum(cut.kept.values()) < sum(done.kept.values())
    assert cut.damage


def test_recover_refuses_a_bag_that_is_not_mcap(space_robot: Tool, run_log: Path, tmp_path: Path) -> None:
    """SQLite has tools of its own for that: one line, and no directory."""
    write("sqlite", run_log, tmp_path / "bag")
    refused(space_robot("recover", "bag"), "plain MCAP")
    assert not (tmp_path / "bag_recovered").exists()
