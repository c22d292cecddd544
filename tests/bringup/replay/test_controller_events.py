"""What was done to the controller of a run, and how the run ended, is done again."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.replay.golden import update_reference
from space_robot_bringup.replay.recording import Code
from space_robot_bringup.replay.replay import Replayed
from space_robot_control.laws.switching import Switching
from space_robot_msgs_py.codec.codecs import LOGGED, TickCodec
from space_robot_msgs_py.interfaces import Tick
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.log.writer import LogSink, LogWriter
from tests.support.replays import assert_equal, first, one, record_run, replayed, rewritten

SHORT = "duration=5.0"
PERIOD = 250_000_000


def test_replay_repeats_the_missed_commands_of_a_paced_run(tmp_path: Path) -> None:
    """Where the telemetry says that an older command acted, the fresh plant gets that one; no law is asked twice."""
    done = replayed(run_with_losses(tmp_path / "paced", "liu2023/fig11"))
    assert done.equal, [outcome.first for outcome in done.outcomes]
    assert "states have no recorded answer" in done.outcomes[0].remarks[0]
    assert "run with an older command" in done.outcomes[1].remarks[0]


def run_with_losses(place: Path, experiment: str) -> Path:
    """What a paced run leaves: commands that came one period late, and some that never came."""
    composition = compose(load_experiment(experiment, [SHORT]))
    plant, law, reference = composition.plant(), composition.controller(), composition.reference()
    codec, writer = TickCodec(composition.joint_names), LogWriter(place, composition.header)
    writer.write_description(composition.header.urdf)
    sample, late = plant.reset(), None
    for index in range(21):
        asked = reference.at(sample.state.stamp)
        if index % 7 == 3:
            # No controller is there to answer, and the next one is reset.
            law.reset_in_run()
            row = codec.encode_unanswered(sample, asked)
            due, late = late, None
        else:
            output = law.update(sample.state, asked)
            row = codec.encode(Tick(sample, asked, output))
            due = late if index % 7 == 2 else output.command
            late = output.command if index % 7 in (2, 5) else None
        writer.write_tick(sample.state.stamp, {t: raw for t, raw in zip(LOGGED, row, strict=True) if raw is not None})
        sample = plant.step(due)
    writer.close("completed")
    return place


def test_recorded_gain_changes_are_replayed(tmp_path: Path) -> None:
    """A run in which gains were set at some state replays with them set there; without the event it differs there."""
    bag = tuned(tmp_path / "run", {7: {"gains.damping": 0.8}, 15: {"gains.damping": 0.7}})
    assert_equal(bag)
    names = ("controller/events",)
    forgotten = one(replayed(rewritten(bag, tmp_path / "forgotten", drop=names), against="controller"))
    assert first(forgotten).stamp == 7 * PERIOD
    other = replayed(bag, against="controller", overrides=["controller.law=none"])
    assert "do not fit" in one(other).remarks[0]


def test_recorded_switches_are_replayed(tmp_path: Path) -> None:
    """A requested switch replays where it happened; scheduled ones come by themselves."""
    bag = tuned(tmp_path / "run", {6: "ntsmc", 13: "mfac"}, "switch/mini", "controller.switches=[]")
    assert_equal(bag)
    assert not update_reference(replayed(bag).recording), "the same run, switches and all, is another file"
    forgotten = rewritten(bag, tmp_path / "forgotten", drop=("controller/events",))
    assert first(one(replayed(forgotten, against="controller"))).stamp == 6 * PERIOD
    assert_equal(
        record_run(tmp_path / "scheduled", "switch/mini", SHORT, "controller.switches=[{time: 2.0, to: ntsmc}]")
    )


def tuned(
    place: Path,
    changes: dict[int, Any],
    experiment: str = "compare/mini",
    override: str = "controller.law=computed_torque",
) -> Path:
    """A run whose gains are set, or whose law is switched, at some ticks."""
    composition = compose(load_experiment(experiment, [SHORT, override]))
    plant, law, reference = composition.plant(), composition.controller(), composition.reference()
    sink = LogSink(place, composition.header)
    sample = plant.reset()
    for index in range(21):
        if isinstance(changes.get(index), str):
            assert isinstance(law, Switching)
            law.switch_to(changes[index])
        elif index in changes:
            law.tune(changes[index])
        asked = reference.at(sample.state.stamp)
        output = law.update(sample.state, asked)
        sink.record(Tick(sample, asked, output))
        sample = plant.step(output.command)
    sink.close("completed")
    return place


@pytest.mark.parametrize("law", ["gives_up", "none"])
def test_a_run_that_ended_with_an_error_ends_so_again(tmp_path: Path, law: str) -> None:
    """The reason of the end is compared too: the same law gives up at the same state with the same words."""
    name = "tests.support.laws:GivesUp" if law == "gives_up" else "none"
    bag = record_run(tmp_path / "run", "compare/mini", SHORT, f"controller.law={name}")
    code = Code(allowed=True)
    assert_equal_up_to_the_end(replayed(bag, code=code))
    if law == "gives_up":
        other = replayed(bag, against="controller", overrides=["controller.law=none"])
        assert first(one(other)).field in ("patience", "answer")
        forged = rewritten(bag, tmp_path / "forged", end="controller: out of fuel")
        again = replayed(forged, against="controller", code=code)
        assert first(one(again)).recorded == "controller: out of fuel"


def assert_equal_up_to_the_end(done: Replayed) -> None:
    assert [outcome.first for outcome in done.outcomes] == [None, None]


def test_a_plant_that_broke_breaks_again(tmp_path: Path) -> None:
    """An integration that failed in the run fails in the replay, with the same reason."""
    broken = ("initial.angular_velocity=[1.0e14, 0, 0]", "controller.law=none")
    bag = record_run(tmp_path / "run", "compare/mini", SHORT, *broken)
    assert (LogReader(bag).end_reason or "").startswith("simulator: ")
    assert_equal_up_to_the_end(replayed(bag))
    forged = rewritten(bag, tmp_path / "forged", end="simulator: out of fuel")
    assert first(one(replayed(forged, against="plant"))).field == "state"
