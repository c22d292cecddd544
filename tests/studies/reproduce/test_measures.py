"""Numbers over runs: a run without a number is never dropped in silence, a failed run never counts as a success."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_msgs_py.errors import SpecError
from space_robot_studies.intervals import wilson
from space_robot_studies.reproduce.claims import Judgement, check_words, judge, seed_text
from space_robot_studies.reproduce.manifest import Bounds, Claim, Figure
from space_robot_studies.reproduce.measures import FinishedRun, reduce, select, take
from space_robot_studies.reproduce.planner import DistinctRun, PlannedRun, ReadingRuns
from space_robot_studies.reproduce.quantities import Measure, Number, Quantity
from space_robot_studies.reproduce.readings import UNDECIDED, Reading
from space_robot_studies.reproduce.run_data import RunData
from space_robot_studies.reproduce.timing import CycleTimes

BOUNDS = Bounds()
SMALL = {"attitude": 10.0, "joints": 5.0}


def data(settling: float | None = 1.0, *, reason: str = "completed", **more: Any) -> RunData:
    return RunData(reason, metrics={"settling": settling}, **{"largest": SMALL, **more})


def finished(*all_data: RunData, group: str = "all") -> list[FinishedRun]:
    experiment = load_experiment("liu2023/fig08")
    runs = []
    for seed, one in enumerate(all_data):
        planned = DistinctRun(f"{group}{seed}", "x", (), experiment.model_copy(update={"seed": seed}))
        runs.append((PlannedRun(f"{group} {seed}", group, {"seed": seed}, planned), one))
    return runs


def figure(*claims: Claim) -> Figure:
    return Figure.model_validate({"title": "t", "runs": {"all": {"experiment": "x"}}, "claims": list(claims)})


def claim(**keys: Any) -> Claim:
    base = {
        "paper": "It is fast.",
        "measures": {"slowest": {"metric": "settling", "of": "all", "reduce": "max"}},
        "holds_if": "slowest < 5",
        "found": "{slowest:.1f} s over {n} runs, seeds {seeds}",
        "expect": "holds",
    }
    return Claim.model_validate(base | keys)


def judged(one: Claim, runs: list[FinishedRun]) -> Judgement:
    """The claim on these runs, in its only reading."""
    groups: dict[str, tuple[PlannedRun, ...]] = {}
    for run, _ in runs:
        groups[run.group] = (*groups.get(run.group, ()), run)
    left = {run.label: data for run, data in runs}
    return judge(one, figure(one), [ReadingRuns(Reading({}, {}), groups)], lambda run: left[run.label])


def test_reductions_are_those_of_numpy() -> None:
    """Each reduction over the runs is what its name says."""
    values = [3.0, 1.0, 2.0, 7.0]
    runs = finished(*map(data, values))
    want = {"min": 1.0, "max": 7.0, "mean": 3.25, "median": 2.5, "sum": 13.0, "count": 4.0, "std": np.std(values)}
    for name, value in want.items():
        number = Number.model_validate({"metric": "settling", "reduce": name})
        assert reduce(number, runs, BOUNDS).value == pytest.approx(value)


def test_a_run_without_the_number_is_refused_skipped_or_replaced_as_said() -> None:
    """``missing`` decides, and the runs without the number are named in every case."""
    runs = finished(data(1.0), data(None), data(3.0))
    refused = reduce(Number(metric="settling", reduce="mean"), runs, BOUNDS)
    assert refused.value is None
    assert "all 1 without settling" in refused.why
    skipped = reduce(Number(metric="settling", reduce="mean", missing="skip"), runs, BOUNDS)
    replaced = reduce(Number(metric="settling", reduce="mean", missing=8.0), runs, BOUNDS)
    assert (skipped.value, replaced.value) == (2.0, 4.0)
    assert refused.without == skipped.without == replaced.without == ("all 1",)
    assert skipped.runs == 3


def test_a_measure_without_runs_has_only_a_count_and_a_sum() -> None:
    """When every run lacks the number only its count and sum exist."""
    runs = finished(data(None))
    assert reduce(Number(metric="settling", reduce="max", missing="skip"), runs, BOUNDS).value is None
    assert reduce(Number(metric="settling", reduce="count", missing="skip"), runs, BOUNDS).value == 0.0


@pytest.mark.parametrize(
    "bad",
    [
        data(1.0, reason="controller: had enough"),
        data(1.0, reason="interrupted"),
        data(1.0, broken=("energy_residual",)),
        RunData("a metric is not finite"),
    ],
)
def test_a_failed_run_has_diverged_and_lends_no_number(bad: RunData) -> None:
    """A run that did not complete, or whose plant was wrong, counts as diverged and has no metric to count."""
    assert bad.number(Quantity("completed"), BOUNDS) == 0.0
    assert bad.number(Quantity("diverged"), BOUNDS) == 1.0
    assert bad.number(Quantity("settling"), BOUNDS) is None
    assert bad.number(Quantity(signal="base.error", take="max"), BOUNDS) is None


@pytest.mark.parametrize(("name", "value"), [("attitude", 91.0), ("joints", 181.0), ("position", 10.1)])
def test_a_run_that_leaves_the_bounds_has_diverged(name: str, value: float) -> None:
    """A completed run with an error beyond a bound has diverged, and wider bounds forgive it."""
    wild = data(1.0, largest=SMALL | {name: value})
    assert wild.completed
    assert wild.diverged(BOUNDS)
    assert not wild.diverged(Bounds.model_validate({name: 2.0 * value}))
    assert not data(1.0).diverged(BOUNDS)


def test_a_number_of_a_signal_is_taken_in_its_window() -> None:
    """After and before cut the signal, ends included; an empty window has no number."""
    time, signal = np.arange(5.0), np.array([9.0, -4.0, 1.0, 2.0, -8.0])
    for name, value in {"final": 2.0, "max": 2.0, "min": -4.0, "max_abs": 4.0, "mean": -1.0 / 3.0}.items():
        assert take(Quantity(signal="x", take=name, after=1.0, before=3.0), time, signal) == pytest.approx(value)
    assert take(Quantity(signal="x", take="rms", after=2.0, before=3.0), time, signal) == pytest.approx(np.sqrt(2.5))
    assert take(Quantity(signal="x", take="max", after=9.0), time, signal) is None


def test_where_picks_the_runs_with_a_value() -> None:
    """``where`` leaves only runs whose key has this value."""
    runs = [run for run, _ in finished(data(), data(), data())]
    measure = Measure.model_validate({"metric": "settling", "of": "all", "where": {"seed": 2}})
    assert [run.label for run in select(measure, runs)] == ["all 2"]


def test_a_share_within_a_bound_counts_what_is_at_most_that() -> None:
    """Runs without the number, or beyond the bound, are none of it; the bound itself is; an interval comes with it."""
    runs = finished(data(1.0), data(2.0), data(2.5), data(None))
    for how, value in (("count", 2.0), ("share", 0.5)):
        number = Number.model_validate({"metric": "settling", "reduce": how, "within": 2.0})
        found = reduce(number, runs, BOUNDS).estimate
        assert found is not None
        assert (found.value, found.of) == (value, 4)
    assert (found.low, found.high) == wilson(2, 4)
    with pytest.raises(SpecError, match="within is for reduce: count and share"):
        Number(metric="settling", reduce="max", within=2.0)


def test_a_claim_is_decided_by_its_condition() -> None:
    """The verdict is measured, never taken from the manifest; a difference is a change."""
    fast, slow = finished(data(1.0), data(2.0)), finished(data(1.0), data(9.0))
    held = judged(claim(), fast)
    assert (held.verdict, held.changed) == ("holds", False)
    assert held.readings[0].found == "2.0 s over 2 runs, seeds 0-1"
    failed = judged(claim(), slow)
    assert (failed.verdict, failed.changed) == ("does not hold", True)
    assert not judged(claim(expect="does not hold"), slow).changed


def test_a_claim_without_its_numbers_is_undecided_and_so_changed() -> None:
    """A missing number, or a condition without a value, is no verdict at all."""
    missing = judged(claim(), finished(data(None)))
    assert (missing.verdict, missing.changed) == (UNDECIDED, True)
    divided = claim(holds_if="1 / (slowest - slowest) > 0")
    assert judged(divided, finished(data(1.0))).verdict == UNDECIDED


def test_a_claim_that_cannot_be_checked_stays_so() -> None:
    """Not checkable needs a reason, takes no measures, and is never a change."""
    words = {"paper": "It is nice.", "expect": "not checkable"}
    one = Claim.model_validate(words | {"because": "No number is given."})
    assert not judged(one, finished(data())).changed
    assert judged(one.model_copy(update={"expect": "holds"}), finished(data())).changed
    for wrong in ({}, {"because": "x", "holds_if": "1 < 2"}):
        with pytest.raises(ValueError, match="without measures"):
            Claim.model_validate(words | wrong)


def test_a_claim_may_use_cycle_times() -> None:
    """A cycle time is a number of the runs of the timing table; without it the claim is undecided."""
    timed = claim(measures={"slowest": {"timing": "median", "of": "all"}}, holds_if="slowest < 1000")
    times = CycleTimes(30.0, 20.0, 90.0, 100).metrics()
    assert judged(timed, finished(data(cycle_times=times))).readings[0].found.startswith("20.0 s")
    assert judged(timed, finished(data())).verdict == UNDECIDED


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"holds_if": "slowes < 5"}, "slowest"),
        ({"found": "{slowes}"}, "slowest"),
        ({"found": "{slowest.real}"}, "slowest.real"),
        ({"found": "{}"}, "no such measure"),
        ({"found": "{slowest:%q}"}, "format string"),
        ({"found": "{slowest"}, "format string"),
    ],
)
def test_words_of_a_claim_are_checked_before_the_runs(change: dict[str, Any], word: str) -> None:
    """Condition and text name only what there is."""
    with pytest.raises(SpecError, match="figures"):
        check_words(claim(**change), {}, "figures.8.claims.0")
    with pytest.raises(SpecError, match=word):
        check_words(claim(**change), {}, "figures.8.claims.0")


def test_seeds_are_written_shortly() -> None:
    """Neighbouring seeds become ranges."""
    assert seed_text(()) == ""
    assert seed_text((0,)) == "0"
    assert seed_text((1, 2, 3, 7, 9, 10)) == "1-3, 7, 9-10"


def test_an_integral_holds_every_value_until_the_next_tick() -> None:
    """Of a held command the integral is exact, also over unequal periods, and the last value lasts no time."""
    time, signal = np.array([0.0, 1.0, 3.0, 4.0]), np.array([2.0, 3.0, 5.0, 99.0])
    assert take(Quantity(signal="x", take="integral"), time, signal) == 2.0 + 6.0 + 5.0
    assert take(Quantity(signal="x", take="integral", after=1.0), time, signal) == 6.0 + 5.0


def test_settled_is_the_first_time_from_which_a_signal_stays_below() -> None:
    """A signal that comes back has not settled before, and one that ends outside never has."""
    time, signal = np.arange(5.0), np.array([4.0, 0.1, -2.0, 0.1, 0.2])
    assert take(Quantity(signal="x", take="settled", below=1.0), time, signal) == 3.0
    assert take(Quantity(signal="x", take="settled", below=5.0), time, signal) == 0.0
    assert take(Quantity(signal="x", take="settled", below=0.2), time, signal) is None


def test_ticks_without_a_value_do_not_count() -> None:
    """NaN says that a signal has no value at a tick; a signal without any has no number."""
    time, signal = np.arange(3.0), np.array([np.nan, 2.0, 4.0])
    assert take(Quantity(signal="x", take="mean"), time, signal) == 3.0
    assert take(Quantity(signal="x", take="max"), time, np.full(3, np.nan)) is None


def test_pairs_are_judged_where_both_have_the_number() -> None:
    """``only_if`` leaves the runs whose partners of the same seed have a number, in every group it names."""
    quick = finished(data(1.0), data(2.0), data(None), group="quick")
    slow = finished(data(5.0), data(9.0, reason="controller: had enough"), data(7.0), group="slow")
    partners = {"metric": "settling", "of": ["quick", "slow"]}
    measure = {"metric": "settling", "of": "slow", "reduce": "sum", "missing": "skip"}
    both = claim(
        measures={"both": measure | {"only_if": partners}, "all": measure},
        holds_if="both < all",
        found="{both:.0f} of {all:.0f}",
    )
    assert judged(both, [*quick, *slow]).readings[0].found == "5 of 12"
    no_partner = claim(measures={"slowest": measure | {"only_if": {"metric": "settling", "of": ["slow", "absent"]}}})
    assert judged(no_partner, slow).readings[0].found.startswith("0.0 s over 0 runs")


def test_derived_numbers_are_formulas_over_the_measures() -> None:
    """A claim may speak of a saving: computed once, usable in condition and text, undecided where it has no value."""
    saving = claim(derived={"saving": "100 * (1 - slowest / 8)"}, holds_if="saving > 50", found="{saving:.0f} %")
    assert judged(saving, finished(data(2.0))).readings[0].found == "75 %"
    nothing = claim(derived={"part": "1 / (slowest - slowest)"}, holds_if="part > 50")
    assert judged(nothing, finished(data(2.0))).verdict == UNDECIDED
    for wrong in ({"n": "1 + 1"}, {"slowest": "1 + 1"}, {"part": "other * 2"}):
        with pytest.raises(SpecError, match="figures"):
            check_words(claim(derived=wrong), {}, "figures.8.claims.0")


def test_draws_of_a_campaign_are_counted_as_such() -> None:
    """Runs of a campaign are identified by their number, not by a drawn seed of sixteen digits."""
    runs = finished(data(1.0), data(2.0))
    cases = [(replace(run, values={"run": place}), one) for place, (run, one) in enumerate(runs)]
    (one,) = judged(claim(), cases).readings
    assert (one.seeds, one.draws) == ((), (0, 1))


def test_a_run_comes_back_from_plain_data_to_the_last_bit() -> None:
    """What a journal holds of a run is JSON, and gives every number, curve and missing value of it again."""
    asked = {
        Quantity(signal="base.error", take="max"): 0.1 + 0.2,
        Quantity(signal="x", take="settled", below=1.0): None,
    }
    curves = {"base.error": np.array([0.1, np.nan, -0.0, 1e-310]), "x": np.array([np.inf])}
    one = data(1 / 3, broken=("energy_residual",), taken=asked | {Quantity(signal="y", take="rms"): np.inf})
    one = replace(one, time=np.linspace(0.0, 1.0, 4), curves=curves, warnings=("w",), bag=True, lost=True)
    back = RunData.from_columns(json.loads(json.dumps(one.to_columns(), allow_nan=False)))
    for name in ("end_reason", "broken", "metrics", "largest", "taken", "warnings", "bag", "lost"):
        assert getattr(back, name) == getattr(one, name), name
    for name, curve in {"time": one.time, **curves}.items():
        there = back.time if name == "time" else back.curves[name]
        assert there.tobytes() == curve.tobytes()
