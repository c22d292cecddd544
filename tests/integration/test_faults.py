"""Runs with faults: the same bytes in every mode and twice, exact replays, refusals before anything runs."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from space_robot_bringup.experiment.experiment import load_experiment, with_faults
from space_robot_bringup.modes.run import Mode, run_experiment
from space_robot_bringup.replay.replay import ReplayOptions, replay
from space_robot_msgs_py.codec.codecs import decode_statuses
from space_robot_msgs_py.log.reader import LogReader
from space_robot_studies.campaign.cases import check_cases, make_case
from space_robot_studies.campaign.spec import Campaign, resolved
from tests.support.tool import Tool, refused

# One of every group, some at once, from the first tick to the last.
FAULTS = (
    "joint_stuck joint=joint2 at=2 for=3",
    "joint_backlash joint=joint3 at=0 play=0.05",
    "joint_friction joint=joint1 at=1 for=5 viscous=0.2 coulomb=0.01",
    "wheel_effectiveness wheel=1 factor=0.4 at=3.1",
    "wheel_stopped wheel=0 at=6 for=1",
    "payload_captured payload={mass: 1.0, inertia: [0.01, 0.01, 0.01]} at=4 for=3",
    "wrench_pulse torque=[0, 0, 0.2] at=5 for=0.5",
    "sensor_noise channel=angular_velocity sigma=1.0e-4 at=1",
    "sensor_frozen channel=attitude at=7 for=0.75",
    "sensor_outliers channel=joint_position probability=0.2 length=1.0e-3 at=2",
    "sensor_sign_flip probability=0.5 at=0 for=2",
    "sensor_dropout channel=joint_velocity probability=0.3 at=3",
    "link_drop topic=command probability=0.2 at=2 for=4",
    "link_delay topic=state periods=1 at=6 for=2",
    "link_reorder topic=reference probability=0.3 at=1",
    "controller_silent at=8 for=0.75",
    "controller_restarted at=4.5",
)


def experiment(faults: tuple[str, ...] = FAULTS, **overrides: Any) -> Any:
    """The orientation task of `mini` for 10 s, with faults."""
    return with_faults(load_experiment("liu2023/fig08", {"duration": 10.0} | overrides), faults)


def logged(place: Path, mode: Mode = "headless", **overrides: Any) -> bytes:
    """The log of a run with faults."""
    result = run_experiment(experiment(**overrides), place / "run", mode=mode)
    assert result.end_reason == "completed"
    return (place / "run" / "run_0.mcap").read_bytes()


def test_equal_seeds_give_equal_files_and_replay_equal(tmp_path: Path) -> None:
    """Twice the same bytes, another seed others; plant and controller computed again from the log are EQUAL."""
    assert logged(tmp_path / "a") == logged(tmp_path / "b")
    assert logged(tmp_path / "c", seed=8) != logged(tmp_path / "a")
    replayed = replay(tmp_path / "a" / "run", ReplayOptions())
    assert replayed.equal, [outcome.comparison.first for outcome in replayed.outcomes]
    assert [outcome.ticks for outcome in replayed.outcomes] == [41, 41]


def test_a_fault_that_is_another_is_found_by_replay(tmp_path: Path) -> None:
    """Replayed with an onset one tick later, the plant differs, first in the events of the truth."""
    logged(tmp_path)
    faults = experiment().model_dump(mode="json")["faults"]
    faults[3]["at"] = 3.3
    outcome = replay(tmp_path / "run", ReplayOptions("plant", overrides={"faults": faults})).outcomes[0]
    assert not outcome.equal
    assert "faults" in str(outcome.first)


def test_the_log_tells_when_faults_begin_and_end(tmp_path: Path) -> None:
    """Topic `faults` has each onset and end at its tick, in the file and in its description."""
    logged(tmp_path)
    reader = LogReader(tmp_path / "run")
    reported = [(stamp, decode_statuses(raw)) for topic, stamp, raw in reader.messages() if topic == "faults"]
    assert [stamp for stamp, _ in reported] == sorted({stamp for stamp, _ in reported})
    begun = {one.name: stamp / 1e9 for stamp, events in reported for one in events if one.message == "begins"}
    ended = {one.name: stamp / 1e9 for stamp, events in reported for one in events if one.message == "ends"}
    assert len(begun) == len(FAULTS)
    assert begun["joint_stuck joint2"] == 2.0
    assert ended["joint_stuck joint2"] == 5.0
    assert begun["wheel_effectiveness wheel1"] == 3.25
    assert "wheel_effectiveness wheel1" not in ended
    assert reader.header.topics == ("faults",)
    assert [tick.sample.faults for tick in reader.ticks() if tick.sample.faults] == [events for _, events in reported]


def test_a_log_without_faults_has_no_trace_of_them(tmp_path: Path) -> None:
    """Neither channel nor key: the file is what it was before there were faults."""
    result = run_experiment(experiment(faults=()), tmp_path / "run", mode="headless")
    assert result.end_reason == "completed"
    assert b"faults" not in (tmp_path / "run" / "run_0.mcap").read_bytes()


@pytest.mark.ros
@pytest.mark.xdist_group("graph")
@pytest.mark.parametrize("mode", ["graph", "processes"])
def test_every_mode_logs_the_same_bytes(tmp_path: Path, mode: Mode) -> None:
    """Several faults at once, with noise and random outliers: one file, whatever carried the messages."""
    pytest.importorskip("rclpy")
    assert logged(tmp_path / mode, mode) == logged(tmp_path / "headless")


def test_the_command_line_takes_faults(space_robot: Tool, tmp_path: Path) -> None:
    """`run --fault` runs with it; its log says so like one of a file."""
    place, typed = tmp_path / "run", ("--fault", FAULTS[0], "--fault", FAULTS[10])
    done = space_robot("run", "liu2023/fig08", "--duration", "6", *typed, "--out", str(place), "--json")
    assert done.returncode in (0, 1), done.stderr
    assert json.loads(done.stdout)["end_reason"] == "completed"
    faults = [one.name for tick in LogReader(place).ticks() for one in tick.sample.faults]
    assert sorted(set(faults)) == ["joint_stuck joint2", "sensor_sign_flip attitude"]


@pytest.mark.parametrize(
    ("fault", "said"),
    [
        ("joint_stuck joint=joint9 at=2", "faults.0.joint: no such joint; got 'joint9'"),
        ("joint_stuck joint=joint2 at=40", "faults.0.at: is not within the run"),
        ("wheel_stopped wheel=5 at=2", "accepted: 0 to 2"),
        ("joint_melted joint=joint2 at=2", "no such kind of fault"),
    ],
)
def test_what_cannot_go_wrong_is_refused_before_anything_runs(
    space_robot: Tool, tmp_path: Path, fault: str, said: str
) -> None:
    """One line, exit code 2, no directory."""
    for arguments in (("run", "liu2023/fig08", "--out", "run"), ("check", "liu2023/fig08")):
        refused(space_robot(*arguments, "--fault", fault), said)
    assert not (tmp_path / "run").exists()


def test_list_explains_the_faults(space_robot: Tool) -> None:
    """Every kind with its keys; an unknown list is refused."""
    done = space_robot("list", "faults")
    assert done.returncode == 0
    assert "joint_backlash" in done.stdout
    assert "from flank to flank [rad or m]" in done.stdout
    refused(space_robot("list", "failures"), "failures", "faults")


@pytest.mark.parametrize("kind", ["airbearing", "pccs"])
def test_other_plants_know_no_faults(space_robot: Tool, kind: str) -> None:
    """A plant that would ignore them refuses them."""
    name = {"airbearing": "song2023/attitude_1_7", "pccs": "song2023/pccs"}[kind]
    done = space_robot("check", name, "--fault", "wrench_pulse force=[1, 0, 0] at=1")
    refused(done, "faults: this plant knows no faults", kind)


def test_a_campaign_disperses_numbers_of_faults() -> None:
    """Onset and size are drawn like any key, and a case with a window beyond the run is refused before it runs."""
    base = experiment((FAULTS[0], FAULTS[3])).model_dump(mode="json")
    spread = {
        "faults.0.at": {"uniform": {"low": 1.0, "high": 5.0}},
        "faults.1.factor": {"uniform": {"low": 0.0, "high": 1.0}},
    }
    campaign = resolved(
        Campaign.model_validate({"experiment": base, "runs": 5, "disperse": spread}), Path("campaign.yaml")
    )
    assert len(check_cases(campaign)) == 1
    onsets = {make_case(campaign, index).experiment().faults[0].at for index in range(5)}
    assert len(onsets) == 5
    late = campaign.model_copy(update={"disperse": Campaign.model_validate(
        {"experiment": base, "runs": 5, "disperse": {"faults.0.at": {"uniform": {"low": 8.0, "high": 9.0}}}}
    ).disperse})  # fmt: skip
    with pytest.raises(ValueError, match=r"case 0.*faults\.0\.for: goes beyond the run"):
        check_cases(late)
