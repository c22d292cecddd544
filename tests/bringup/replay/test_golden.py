"""Golden logs: each controller on two robots, run once and for all, replayed here against what is in the tree now."""

from __future__ import annotations

import json
from copy import deepcopy

import pytest

from space_robot_bringup.experiment.dotted_keys import set_key
from space_robot_bringup.replay.comparison import Tolerance
from space_robot_bringup.replay.recording import flat, open_recording
from space_robot_bringup.replay.replay import ReplayOptions, replay
from space_robot_control.laws.registry import BUILT_IN
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.log.reader import LogReader
from tests.support.paths import ROOT

FOLDER = ROOT / "tests" / "data" / "golden"
GOLDEN = sorted(path.name for path in FOLDER.iterdir() if path.is_dir())
# Another processor sums in another order: see docs/replay.md.
NEARLY = Tolerance(rtol=5e-9, atol=1e-12)
BREAK = 1.0 + 1e-6
# Gains that do nothing in these runs, and why.
IDLE = {
    "rls.bandwidth": "of update rls_filtered alone",
    "rls.reset.threshold": "no estimate is reset",
    "tracking.gain": "the weight does not follow a moving parameter",
    "tracking.floor": "likewise",
    "pitch_limit_deg": "no run gets near it",
    "smallest_cosine": "no run gets near it",
    "estimator.floor": "no pseudo-gradient falls that low",
    "initial.seconds": "Phi(1) comes from the model",
    "initial.trust": "likewise",
    "initial.level": "likewise",
    "posture_step": "the arm passes it within the same period",
}
IDLE_ON_A_FLOATING_BASE = ("rls.force_noise", "translation")


@pytest.mark.parametrize("name", GOLDEN)
def test_the_golden_logs_replay(name: str) -> None:
    """Controller and plant of today give the commands and states of the day the log was made."""
    outcomes = replay(FOLDER / name, ReplayOptions(tolerance=NEARLY)).outcomes
    assert [outcome.against for outcome in outcomes] == ["controller", "plant"]
    for outcome in outcomes:
        assert outcome.first is None, f"{outcome.first}; if it is meant so: make golden"
        assert outcome.absent == ()
        assert outcome.ticks == 21


def test_each_controller_is_there_on_two_robots() -> None:
    """Every shipped law but the one that does nothing, on mini and on servicer, in less than 3 MB."""
    laws = set(BUILT_IN) - {"none"}
    assert {f"{law}_{robot}" for law in laws for robot in ("mini", "servicer")} == set(GOLDEN)
    assert sum(path.stat().st_size for path in FOLDER.rglob("*") if path.is_file()) < 3_000_000
    assert {LogReader(FOLDER / name).end_reason for name in GOLDEN} == {"completed"}


@pytest.mark.parametrize("name", GOLDEN)
def test_a_gain_that_is_a_millionth_off_is_caught(name: str) -> None:
    """Every gain that matters, one by one, and with the same tolerance that forgives another processor."""
    gains = open_recording(FOLDER / name).composition.controller().gains.model_dump(mode="json", by_alias=True)
    tried = 0
    for key, value in flat(gains).items():
        idle = key in IDLE or (name.endswith("_mini") and key.endswith(IDLE_ON_A_FLOATING_BASE))
        if isinstance(value, float) and value and not idle:
            broken = deepcopy(gains)
            set_key(broken, key, value * BREAK, key)
            options = ReplayOptions("controller", NEARLY, [f"controller.gains={json.dumps(broken)}"])
            assert not replay(FOLDER / name, options).equal, key
            tried += 1
    assert tried


def test_a_broken_plant_is_caught() -> None:
    """A millionth of a kilogram in the payload of the true robot moves the states."""
    name = "computed_torque_mini"
    recording = open_recording(FOLDER / name)
    payload = recording.composition.experiment.plant.payload
    assert payload is not None
    options = ReplayOptions("plant", NEARLY, [f"plant.payload.mass={payload.mass * BREAK!r}"])
    assert not replay(FOLDER / name, options).equal
    with pytest.raises(SpecError):
        ReplayOptions("wall")
