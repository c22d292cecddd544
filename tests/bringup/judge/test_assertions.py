"""What an experiment expects over time, of events and modes: judged alike wherever a run is judged, refused early."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import space_robot
from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import Experiment, experiment_from, load_experiment, to_yaml
from space_robot_bringup.judge.check import Check
from space_robot_bringup.judge.judging import judge_ticks
from space_robot_bringup.logs.assessed import read_judged
from space_robot_bringup.logs.info import bag_info
from space_robot_bringup.modes.headless import run_in_memory, write_bag
from space_robot_description.validation import parse_yaml_text
from space_robot_msgs_py.errors import SpecError

IN_TASK: dict[str, Any] = {"in": ["NOMINAL"], "to": "SAFE"}
# A jet pushes the base; the supervisor of the robot falls back to damping.
PUSHED: dict[str, Any] = {
    "duration": 12.0,
    "supervision": {
        "modes": {"NOMINAL": {}, "SAFE": {"law": "detumble", "gains": {"rate": 2.0}, "reference": "here"}},
        "monitors": [
            {"name": "tumbling", "value": "base.rate", "above": 0.3, "for": 3, "severity": "high", **IN_TASK},
            {"name": "attitude_lost", "value": "error.attitude", "above": 0.6, "for": 20, **IN_TASK},
        ],
    },
    "faults": [{"kind": "wrench_pulse", "torque": [0.0, 0.0, 4.0], "at": 4.0, "for": 1.0, "name": "jet"}],
}
EXPECT: dict[str, Any] = {
    "base/roll.rms_error": {"max": 20.0, "id": "REQ-001"},
    "base.rate": [
        {"never_above": 0.3, "until": "jet", "id": "REQ-002"},
        {"never_above": 0.3, "for": 0.5},
        {"below": 0.5, "within": 6.0, "after": "jet", "for": 1.0, "id": "REQ-003"},
    ],
    "mode": {
        "SAFE": {"within": 1.5, "after": "jet", "id": "REQ-042"},
        "NOMINAL": [{"always": True}, {"at_end": True}],
    },
    "events": {
        "tumbling": {"at_most": 1, "at_least": 1},
        "attitude_lost fires": {"never": True},
        "jet ends": {"never": True},
    },
}
WORDS = ["holds", "holds", "fails", "holds", "holds", "fails", "fails", "holds", "holds", "fails"]


@pytest.fixture(scope="module")
def judged(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, tuple[Check, ...]]:
    """A bag of that run, and how the run in memory is judged."""
    composition = compose(load_experiment("liu2023/fig08", PUSHED | {"expect": EXPECT}))
    sink = run_in_memory(composition)
    place = tmp_path_factory.mktemp("pushed") / "run"
    write_bag(sink, composition, place)
    return place, judge_ticks(sink.ticks, composition, str(sink.end_reason))[1]


def test_every_expectation_has_its_verdict(judged: tuple[Path, tuple[Check, ...]]) -> None:
    """Holds or fails with the id of the requirement and a reason that names value, time and tick."""
    checks = [check for check in judged[1] if check.about != "run"]
    assert [check.word for check in checks] == WORDS, [check.line for check in checks]
    assert [check.requirement for check in checks] == ["REQ-001", "REQ-002", "", "REQ-003", "REQ-042", *[""] * 5]
    failed = {check.name: check for check in checks if not check.passed}
    assert "rad/s at 4.75 s (tick 19), since 4.25 s; at worst" in failed["base.rate"].reason
    assert failed["mode.NOMINAL"].reason == "mode SAFE at 12 s (tick 48)"
    assert failed["events.jet ends"].reason == "it happened at 5 s (tick 20)"
    assert all("(tick " in check.reason for check in failed.values())


def test_the_log_is_judged_as_the_run_was(judged: tuple[Path, tuple[Check, ...]]) -> None:
    """The run in memory, its log, the page, ``info`` and ``space_robot.judge`` have the same verdict, word for word."""
    place, checks = judged
    assert read_judged(place).checks == checks
    assert space_robot.judge(place) == checks
    # Damage is looked for by `info` alone; what it lacks of a tick it does not say.
    assert [check.line for check in bag_info(place).verdict.checks] == [check.line for check in checks]


def test_a_recorded_run_is_judged_by_other_expectations(judged: tuple[Path, tuple[Check, ...]]) -> None:
    """From Python any expectation can be asked of a log, with the same names and the same refusals."""
    found = space_robot.judge(judged[0], {"base.rate": {"never_above": 100.0, "id": "REQ-9"}})[-1]
    assert (found.passed, found.requirement) == (True, "REQ-9")
    with pytest.raises(SpecError, match=r"expect\.base\.rat.*base\.rate"):
        space_robot.judge(judged[0], {"base.rat": {"never_above": 1.0}})


def test_a_run_asserts_what_is_expected_of_it() -> None:
    """In a test ``run.expect`` is silent about what holds, and names what does not, or is not judged, line by line."""
    run = space_robot.run("liu2023/fig08", {"duration": 5.0, "expect": {}, "supervision": "mini_basic"})
    (check,) = run.expect({"mode": {"NOMINAL": {"always": True}}})
    assert check.passed
    with pytest.raises(AssertionError) as caught:
        run.expect({"base.rate": {"never_above": 0.01, "id": "REQ-7"}, "mode": {"SAFE": {"within": 9.0}}})
    failed, open_ = str(caught.value).splitlines()
    assert failed.startswith("failed: base.rate (REQ-7), wanted never above 0.01 rad/s: 0.0")
    assert open_ == (
        "not judged: mode.SAFE, wanted within 9 s after the start: the run ended at 5 s, too soon after 0 s"
    )


REFUSALS: dict[str, tuple[str, tuple[str, ...]]] = {
    "a signal there is not": ("{base.rat: {never_above: 1}}", ("expect.base.rat", "base.rate")),
    "a metric with a condition": ("{base/roll.final_error: {never_above: 1}}", ("expect.base/roll.final_error", "max")),
    "a signal with a bound": ("{base.rate: {max: 1}}", ("expect.base.rate", "never_above")),
    "a mode there is not": ("{mode: {SAVE: {never: true}}}", ("expect.mode.SAVE", "SAFE")),
    "an event there is not": ("{events: {jetty: {never: true}}}", ("expect.events.jetty", "jet")),
    "a moment there is not": (
        "{base.rate: {below: 1, within: 1, after: jetty}}",
        ("expect.base.rate.after", "'jetty'", "jet"),
    ),
    "no pattern": ("{base.rate: {below: 1}}", ("expect.base.rate", "within")),
    "two patterns": ("{mode: {SAFE: {never: true, within: 1}}}", ("expect.mode.SAFE", "exactly one")),
    "two conditions": ("{base.rate: {never_below: 1, never_above: 2}}", ("expect.base.rate", "exactly one")),
    "a key there is not": ("{base.rate: {nevr_above: 1}}", ("expect.base.rate.nevr_above", "never_above")),
    "a window without an inside": ("{base.rate: {never_above: 1, after: 3, until: 2}}", ("after must be before",)),
    "an event that lasts": ("{events: {jet: {at_most: 1, for: 1}}}", ("expect.events.jet.for", "no duration")),
    "a number that is none": ("{base.rate: {never_above: .nan}}", ("expect.base.rate.never_above",)),
    "mode without names": ("{mode: {never: true}}", ("expect.mode",)),
    "more than at most": ("{mode: {SAFE: {at_least: 3, at_most: 2}}}", ("expect.mode.SAFE", "at_least must not be")),
    "until of what is soon": ("{mode: {SAFE: {within: 1, until: 2}}}", ("expect.mode.SAFE", "until is for")),
    "until of the end": ("{mode: {SAFE: {at_end: true, until: jet}}}", ("expect.mode.SAFE", "until is for")),
    "after, at the end": ("{mode: {SAFE: {at_end: true, after: 1}}}", ("expect.mode.SAFE", "after is for")),
    "always for a while": ("{mode: {SAFE: {always: true, for: 1}}}", ("expect.mode.SAFE", "for has no meaning")),
    "never and always": ("{mode: {SAFE: {always: true, never: true}}}", ("expect.mode.SAFE", "exactly one")),
    "a condition with no pattern beside a never": (
        "{base.rate: {never_above: 1, within: 1}}",
        ("expect.base.rate", "exactly one"),
    ),
    "a bound above the other": (
        "{base/roll.final_error: {min: 2, max: 1}}",
        ("expect.base/roll.final_error", "min must"),
    ),
    "no bound": ("{base/roll.final_error: {tolerance: 1}}", ("expect.base/roll.final_error", "give value, min or max")),
    "an event that is always": ("{events: {jet: {always: true}}}", ("expect.events.jet.always", "no duration")),
    "an event at the end": ("{events: {jet: {at_end: true}}}", ("expect.events.jet.at_end", "no duration")),
    "an end that there is not": (
        "{base.rate: {never_above: 1, until: jetty}}",
        ("expect.base.rate.until", "'jetty'", "jet"),
    ),
    "a signal with one per name": ("{base.rate: {jet: {never: true}}}", ("expect.base.rate", "signal")),
    "a list of nothing": ("{base.rate: []}", ("expect.base.rate",)),
}


@pytest.mark.parametrize("case", REFUSALS)
def test_what_cannot_be_judged_is_refused_before_the_run(case: str) -> None:
    """One error with the key, and the names that are meant where there are some."""
    text, words = REFUSALS[case]
    with pytest.raises(SpecError) as caught:
        compose(load_experiment("liu2023/fig08", PUSHED | {"expect": parse_yaml_text(f"expect: {text}", "")["expect"]}))
    for word in words:
        assert word in str(caught.value), str(caught.value)


COMMANDED: dict[str, Any] = {
    "duration": 4.0,
    "supervision": {
        "modes": {"NOMINAL": {}, "SAFE": {"law": "damped_hold", "from": ["HOLD"]}, "HOLD": {"reference": "here"}},
        "schedule": [{"at": 1.0, "do": "safe"}, {"at": 2.0, "start": "rest"}],
        "sequences": {"rest": [{"after": 0.5, "do": "hold"}]},
    },
    "expect": {
        "events": {
            "command safe refused": {"at_least": 1, "at_most": 1},
            "command safe accepted": {"never": True},
            "sequence rest": {"at_least": 1},
            "sequence rest ends": {"at_least": 1},
        },
        "mode": {"HOLD": {"within": 0.5, "after": "sequence rest"}},
    },
}


def test_commands_and_sequences_are_events_to_expect() -> None:
    """A command has its name and the answer, a sequence its name and what became of it."""
    composition = compose(load_experiment("liu2023/fig08", COMMANDED))
    sink = run_in_memory(composition)
    checks = judge_ticks(sink.ticks, composition, str(sink.end_reason))[1]
    found = {check.name: check.line for check in checks if check.about != "run" and not check.passed}
    assert not found


def test_modes_are_expected_of_supervised_runs_alone() -> None:
    """Without a supervisor there is no mode, and the error says what is lacking."""
    with pytest.raises(SpecError, match=r"expect\.mode\.SAFE.*supervision"):
        compose(load_experiment("liu2023/fig08", {"expect": {"mode": {"SAFE": {"never": True}}}}))


def test_the_resolved_experiment_says_the_same_again() -> None:
    """What is expected goes through a log unchanged, and bounds alone are written as before there were conditions."""
    first = load_experiment("liu2023/fig08", PUSHED | {"expect": EXPECT})
    again = experiment_from(parse_yaml_text(to_yaml(first), ""), "")
    assert again.expect == first.expect
    assert to_yaml(again) == to_yaml(first)
    plain: Experiment = load_experiment("liu2023/fig08")
    assert plain.model_dump(mode="json")["expect"]["base/roll.overshoot"] == {
        "value": None,
        "tolerance": 0.0,
        "min": None,
        "max": 1.0,
    }
