"""Readings: a claim is judged in every one, its verdict follows from theirs, and nothing typed can change it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from space_robot_msgs_py.errors import SpecError
from space_robot_studies.reproduce.check import check_plan
from space_robot_studies.reproduce.claims import judge
from space_robot_studies.reproduce.jobs import job_of
from space_robot_studies.reproduce.plan import Plan, load_plan
from space_robot_studies.reproduce.planner import PlannedRun
from space_robot_studies.reproduce.readings import combined, deciding
from space_robot_studies.reproduce.run_data import RunData

CHOICES: dict[str, Any] = {
    "gain": {
        "open": "Lambda is not printed.",
        "of": ["law"],
        "values": {"1": {}, "2": {"set": {"controller.gains.lambda": 2.0}}},
    },
    "limit": {"open": "?", "ours": True, "values": {"5 s": {"let": {"most": 5}}, "7 s": {"let": {"most": "3 + 4"}}}},
}
CLAIM: dict[str, Any] = {
    "paper": "It is fast.",
    "hangs_on": ["gain", "limit"],
    "measures": {"s": {"metric": "base/roll.settling_time", "of": "law", "reduce": "mean"}},
    "holds_if": "s < most",
    "found": "{s:.1f} s",
}


RUNS = {"law": {"experiment": "liu2023/fig08", "seeds": [1, 2]}, "other": {"experiment": "liu2023/fig08"}}


def plan(folder: Path, claim: dict[str, Any] | None = None, runs: dict[str, Any] = RUNS, **choices: Any) -> Plan:
    figure = {"title": "t", "runs": runs, "claims": [CLAIM | (claim or {})]}
    data = {"title": "t", "citation": "c", "choices": CHOICES | choices, "figures": {"8": figure}}
    (folder / "p.yaml").write_text(json.dumps(data))
    return load_plan(str(folder / "p.yaml"))


def settles(**seconds: float) -> Any:
    """What each run left: seconds to settle, by its value of Lambda."""

    def finished(run: PlannedRun) -> RunData:
        gain = run.distinct.experiment.controller.gains["lambda"]
        return RunData("completed", metrics={"base/roll.settling_time": seconds[f"at_{gain:g}"]})

    return finished


def verdict(one: Plan, **seconds: float) -> str:
    figure = one.manifest.figures["8"]
    return judge(figure.claims[0], figure, one.read["8"][0], settles(**seconds)).verdict


def test_every_combination_is_a_reading_and_only_what_differs_is_run(tmp_path: Path) -> None:
    """Two choices of two values are four readings; a choice that sets nothing needs no run, a group outside none."""
    one = plan(tmp_path)
    labels = [reading.reading.label for reading in one.read["8"][0]]
    assert labels == ["gain: 1, limit: 5 s", "gain: 1, limit: 7 s", "gain: 2, limit: 5 s", "gain: 2, limit: 7 s"]
    assert [run.label for run in one.only_read("8")] == ["law 1 [2]", "law 2 [2]"]
    assert len(one.distinct_runs(["8"])) == 5
    for run in one.only_read("8"):
        job = job_of(one, ["8"], run.distinct, tmp_path)
        assert (job.quantities, job.curves, job.keep) == ((), (), "none")
    varied = {"law": {"experiment": "liu2023/fig08", "vary": {"controller.gains.kappa": [0.5, 0.7]}, "seeds": [1, 2]}}
    measure = CLAIM["measures"]["s"] | {"where": {"controller.gains.kappa": 0.5}}
    picked = plan(tmp_path, {"measures": {"s": measure}}, runs=varied)
    assert len(picked.only_read("8")) == 2


@pytest.mark.parametrize(
    ("at_1", "at_2", "want"),
    [
        (4.0, 4.5, "holds"),
        (9.0, 8.0, "does not hold"),
        (4.0, 9.0, "depends on gain"),
        (6.0, 6.0, "depends on limit"),
        (6.0, 9.0, "depends on gain, limit"),
    ],
)
def test_the_verdict_is_that_of_the_readings(tmp_path: Path, at_1: float, at_2: float, want: str) -> None:
    """All, none, or the choices that turn it."""
    assert verdict(plan(tmp_path), at_1=at_1, at_2=at_2) == want


def test_another_value_of_a_choice_changes_the_verdict(tmp_path: Path) -> None:
    """What depended on a choice holds where its values agree."""
    assert verdict(plan(tmp_path), at_1=4.0, at_2=9.0) == "depends on gain"
    agreed = CHOICES["gain"] | {"values": {"1": {}, "3": {"set": {"controller.gains.lambda": 3.0}}}}
    assert verdict(plan(tmp_path, gain=agreed), at_1=4.0, at_3=4.0) == "holds"


@pytest.mark.parametrize("typed", ["holds", "does not hold", "too close", "not checkable", "study", "depends on limit"])
def test_a_typed_verdict_overrides_nothing(tmp_path: Path, typed: str) -> None:
    """What is expected is only compared: the computed verdict stays, and the difference is an error."""
    one = plan(tmp_path, {"expect": typed})
    figure = one.manifest.figures["8"]
    judged = judge(figure.claims[0], figure, one.read["8"][0], settles(at_1=4.0, at_2=9.0))
    assert (judged.verdict, judged.changed) == ("depends on gain", True)


def test_verdicts_of_readings_combine() -> None:
    """Undecided and too close are never hidden; opposite readings name the fewest choices that differ between them."""
    a, b, c, d = ({"x": x, "y": y} for x in "12" for y in "12")
    assert combined([(a, "holds"), (b, "too close")]) == "too close"
    assert combined([(a, "holds"), (b, "too close"), (c, "does not hold")]) == "depends on x"
    assert combined([(a, "holds"), (b, "too close"), (c, "too close"), (d, "does not hold")]) == "depends on x, y"
    assert combined([(a, "holds"), (b, "undecided"), (c, "does not hold")]) == "undecided"
    assert combined([({}, "study")]) == "study"
    assert deciding([(a, "holds"), (b, "too close")]) == ["y"]
    assert deciding([(a, "holds"), (b, "holds"), (c, "too close"), (d, "does not hold")]) == ["x"]
    assert deciding([(a, "holds"), (d, "holds")]) == []


@pytest.mark.parametrize(
    ("claim", "choices", "words"),
    [
        ({"hangs_on": ["gian"]}, {}, ("claims.0.hangs_on", "gian", "gain")),
        ({"measures": {"s": CLAIM["measures"]["s"] | {"of": "other"}}}, {}, ("hangs_on", "changes no group", "law")),
        ({}, {"limit": {"open": "?", "values": {"a": {}, "b": {"let": {"most": 1}}}}}, ("same names",)),
        ({}, {"gain": {"open": "?", "values": {"a": {}, "b": {}}}}, ("nothing is chosen",)),
        ({}, {"gain": {"open": "?", "values": {"a": {}}}}, ("choices.gain.values",)),
        ({"expect": "hold"}, {}, ("claims.0.expect", "depends on CHOICE")),
        ({"verdict": "holds"}, {}, ("claims.0.verdict", "renamed", "expect")),
        ({"measures": {"s": CLAIM["measures"]["s"] | {"of": "lwa"}}}, {}, ("measures.s.of", "lwa", "law")),
    ],
)
def test_bad_choices_are_refused_by_their_key(
    tmp_path: Path, claim: dict[str, Any], choices: dict[str, Any], words: tuple[str, ...]
) -> None:
    """One line names the key and what would do."""
    with pytest.raises(SpecError) as refusal:
        plan(tmp_path, claim, **choices)
    for word in words:
        assert word in str(refusal.value)


def test_pairs_of_the_same_seed_are_divided(tmp_path: Path) -> None:
    """``over`` divides each number by that of its partner, so that what the seeds have in common drops out."""
    measures = {"ratio": CLAIM["measures"]["s"] | {"over": "law"}}
    change = {"hangs_on": [], "measures": measures, "holds_if": "ratio == 1", "found": "{ratio:.2f}"}
    assert verdict(plan(tmp_path, change), at_1=4.0) == "holds"


def test_a_partner_has_the_same_varied_value(tmp_path: Path) -> None:
    """Where a group varies a key, ``where`` picks both runs of a pair; without it there are several: refused."""
    runs = {"law": {"experiment": "liu2023/fig08", "vary": {"controller.gains.lambda": [1.0, 2.0]}, "seeds": [1, 2]}}
    measure = CLAIM["measures"]["s"] | {"over": "law", "where": {"controller.gains.lambda": 1.0}}
    change = {"hangs_on": [], "measures": {"ratio": measure}, "holds_if": "ratio == 1", "found": "{ratio:.2f}"}
    assert verdict(plan(tmp_path, change, runs=runs), at_1=4.0, at_2=8.0) == "holds"
    several = plan(tmp_path, change | {"measures": {"ratio": CLAIM["measures"]["s"] | {"over": "law"}}}, runs=runs)
    with pytest.raises(SpecError, match="several partners"):
        check_plan(several, ["8"])
