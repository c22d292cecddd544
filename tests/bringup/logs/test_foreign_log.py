"""A bag of another tool is shown as far as it goes, and what it lacks is said."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from mcap.writer import CompressionType

from space_robot_bringup.logs.assessed import JudgedLog, read_judged
from space_robot_bringup.logs.foreign_bag import Source
from space_robot_bringup.logs.foreign_log import read_shown
from space_robot_msgs_py.codec.generic import parse, serialise
from space_robot_msgs_py.errors import LogError
from tests.support.foreign_bags import FIRST, SHORT, TYPES, recorded, since_1970, with_mcap, write
from tests.support.replays import record_run

ROBOT = ("robot_description", "base/odom", "joint_states")
Messages = list[tuple[str, int, bytes]]


@pytest.fixture(scope="module")
def run_log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three seconds of a noisy run."""
    return record_run(tmp_path_factory.mktemp("logs") / "run", "liu2023/noise", SHORT)


def shown(tmp_path: Path, messages: Messages | Iterator[tuple[str, int, bytes]], *given: object) -> JudgedLog:
    with_mcap(tmp_path / "bag.mcap", messages, CompressionType.ZSTD)
    return read_shown(tmp_path / "bag.mcap", *given)  # type: ignore[arg-type]


def only(log: Path, *names: str) -> Messages:
    return [one for one in recorded(log) if one[0] in names]


@pytest.mark.parametrize("form", ["sqlite", "namespace"])
def test_a_whole_bag_of_another_tool_shows_what_the_log_shows(run_log: Path, tmp_path: Path, form: str) -> None:
    """Whatever wrote it: states, references, commands, telemetry and events are those of the run."""
    bag = write(form, run_log, tmp_path / "bag")
    found, log = read_shown(bag, None, Source("robot1") if form == "namespace" else Source()), read_judged(run_log)
    for name in ("stamp", "q", "v", "q_d", "wrench", "effort_command"):
        assert np.array_equal(getattr(found.arrays, name)[: log.ticks], getattr(log.arrays, name)), name
    assert found.arrays.plant.keys() == log.arrays.plant.keys()
    assert found.header.urdf == log.header.urdf
    assert (found.happened, found.absent, found.checks) == (log.happened, frozenset(), ())


def test_robot_base_and_joints_are_enough(run_log: Path, tmp_path: Path) -> None:
    """Nothing else in it: the motion is that of the run, and it says that nothing desired and no command is known."""
    found, log = shown(tmp_path, only(run_log, *ROBOT)), read_judged(run_log)
    assert np.array_equal(found.arrays.q[: log.ticks], log.arrays.q)
    assert found.absent == {"reference", "command"}
    assert {"no reference in the bag", "no command in the bag"} <= set(found.troubles)


def test_an_experiment_says_what_a_bag_lacks(run_log: Path, tmp_path: Path) -> None:
    """Without a robot in the bag the error asks for one; the experiment brings it, and what was desired."""
    messages, log = only(run_log, "base/odom", "joint_states"), read_judged(run_log)
    with pytest.raises(LogError, match="no robot in it; accepted: a message on /robot_description, or --experiment"):
        shown(tmp_path, messages)
    found = shown(tmp_path, messages, "liu2023/noise")
    assert found.absent == {"command"}
    assert np.array_equal(found.arrays.q_d[: log.ticks], log.arrays.q_d)
    assert any("by the experiment" in line for line in found.troubles)


def test_stamps_since_1970_are_shown_from_the_first_state(run_log: Path, tmp_path: Path) -> None:
    """With ``--start first`` the times are those of the run."""
    found = shown(tmp_path, since_1970(run_log), None, FIRST)
    log = read_judged(run_log)
    assert np.array_equal(found.arrays.stamp[: log.ticks], log.arrays.stamp)


def as_a_robot_sends(messages: Messages) -> Messages:
    """Its own frames, joints without velocity and effort, at every third stamp only."""
    joints = [one for one in messages if one[0] == "joint_states"][::3]
    return [one for one in messages if one[0] != "joint_states" or one in joints]


def test_states_of_a_robot_with_its_own_manners_are_drawn(run_log: Path, tmp_path: Path) -> None:
    """Other frames, no velocities, joints at another rate: poses as recorded, joints as they were last."""
    changed = []
    for name, time, raw in as_a_robot_sends(only(run_log, *ROBOT)):
        if name == "robot_description":
            changed.append((name, time, raw))
            continue
        message = parse(TYPES[name], raw)
        if name == "joint_states":
            message = replace(message, velocity=np.zeros(0), effort=np.zeros(0))
        else:
            message = replace(message, header=replace(message.header, frame_id="odom"), child_frame_id="hull")
        changed.append((name, time, serialise(TYPES[name], message)))
    found, log = shown(tmp_path, changed), read_judged(run_log)
    assert np.array_equal(found.arrays.q[: log.ticks, :7], log.arrays.q[:, :7])
    assert np.array_equal(found.arrays.q[4, 7:], log.arrays.q[3, 7:])
    assert np.count_nonzero(found.arrays.v[:, 6:]) == 0
    assert any("joints of" in line for line in found.troubles)
    assert any("other frames" in line for line in found.troubles)


def test_a_bag_of_other_joints_is_refused(run_log: Path, tmp_path: Path) -> None:
    """States without a joint of the robot in the bag: one line with the joint."""
    messages = []
    for name, time, raw in only(run_log, *ROBOT):
        message = parse(TYPES[name], raw) if name == "joint_states" else None
        if message is not None:
            message.name[0] = "gripper"
        messages.append((name, time, raw if message is None else serialise(TYPES[name], message)))
    with pytest.raises(LogError, match="joint1"):
        shown(tmp_path, messages)
