"""What rows add up to, and how they look on disk."""

from __future__ import annotations

from io import BytesIO
from typing import Any

import numpy as np
import pytest

pq = pytest.importorskip("pyarrow.parquet")

from space_robot_studies.campaign.campaign import judge_groups  # noqa: E402
from space_robot_studies.campaign.spec import Campaign  # noqa: E402
from space_robot_studies.campaign.statistics import Rate, Spread, summarise, summary_names  # noqa: E402
from space_robot_studies.campaign.table import parquet  # noqa: E402
from space_robot_studies.reproduce.estimate import bootstrap, share_of  # noqa: E402


def row(index: int, error: float | None, *, completed: bool = True, passed: bool = True) -> dict[str, Any]:
    reason = "completed" if completed else "controller: enough"
    return {"index": index, "end_reason": reason, "completed": completed, "passed": passed, "error": error}


def test_campaigns_and_reproductions_have_the_same_intervals() -> None:
    """Of equal runs the share and the mean are the same numbers in the summary of a campaign and in a claim."""
    values = np.random.default_rng(3).exponential(2.0, 20)
    rate, spread = Rate.of(18, 20), Spread.of(values, range(20), 0)
    share, mean = share_of(18, 20), bootstrap(values, np.mean)
    assert (rate.low, rate.rate, rate.high) == (share.low, share.value, share.high)
    assert (spread.mean_low, spread.mean, spread.mean_high) == (mean.low, mean.value, mean.high)


def test_the_interval_of_a_mean_covers_the_truth_about_as_often_as_it_says() -> None:
    """In 200 samples of 50 the 95 % bootstrap interval holds the true mean in 90 to 99 % of them."""
    rng = np.random.default_rng(5)
    hits = 0
    for _ in range(200):
        spread = Spread.of(rng.exponential(2.0, 50), range(50), 0)
        hits += spread.mean_low <= 2.0 <= spread.mean_high
    assert 0.90 <= hits / 200 <= 0.99


def test_equal_values_and_single_ones_have_a_point_for_an_interval() -> None:
    """Nothing that spreads gives no interval and no NaN."""
    for values in ([3.0], [3.0] * 10):
        spread = Spread.of(np.array(values), range(len(values)), 0)
        assert (spread.mean_low, spread.mean, spread.mean_high, spread.p05, spread.p95) == (3.0,) * 5


def test_missing_numbers_and_ended_runs_are_counted_and_not_averaged() -> None:
    """Numbers come from completed runs that have them; the others are counted, and no failed run is a success."""
    rows = [row(0, 1.0), row(1, None), row(2, 3.0, passed=False), row(3, 99.0, completed=False, passed=False)]
    rows = [one | {"never": None} for one in rows]
    group = summarise(rows, {}, ["error", "never", "of another robot"])
    spread = group.spreads["error"]
    assert (spread.n, spread.missing, spread.mean, spread.max, spread.worst) == (2, 1, 2.0, 3.0, 2)
    assert group.spreads.keys() == {"error", "never"}
    never = group.spreads["never"]
    assert (never.n, never.missing, never.mean, never.mean_low, never.worst) == (0, 3, None, None, None)
    assert (group.success.count, group.success.n, group.completed.count) == (2, 4, 3)
    assert group.reasons == {"controller: enough": 1}
    assert group.failed == (2, 3)
    assert set(group.flat()) <= set(summary_names(["error", "never"]))


def test_the_summary_of_equal_rows_is_always_the_same() -> None:
    """Resampling has a seed of its own."""
    rows = [row(index, float(index % 7)) for index in range(30)]
    assert summarise(rows, {}, ["error"]) == summarise(rows, {}, ["error"])


def test_a_parquet_table_keeps_every_number_and_null() -> None:
    """What is read from the Parquet file are the rows, bit for bit, typed, with null where a row has no such number."""
    third = 1.0 / 3.0
    rows = [
        row(0, third) | {"key": "a", "delay": 1},
        {"index": 1, "end_reason": "error: no", "completed": False, "passed": False, "key": 2.5, "delay": None},
        row(2, None) | {"key": None, "delay": 0, "late": True},
    ]
    table = pq.read_table(BytesIO(parquet(rows, {"campaign": "text"})))
    assert table.schema.metadata[b"campaign"] == b"text"
    types = {name: str(table.schema.field(name).type) for name in table.column_names}
    assert types == {
        "index": "int64",
        "end_reason": "string",
        "completed": "bool",
        "passed": "bool",
        "error": "double",
        "key": "string",
        "delay": "int64",
        "late": "bool",
    }
    assert table.column("error").to_pylist() == [third, None, None]
    assert table.column("key").to_pylist() == ["a", "2.5", None]
    assert parquet(rows, {"campaign": "text"}) == parquet(iter(rows), {"campaign": "text"})


def test_bounds_of_a_campaign_hold_at_every_point_of_its_grid() -> None:
    """Each point is judged by itself and named; a point of which no run completed fails whatever was expected."""
    bounds = {"error.mean": {"max": 1.5}, "success_rate": {"min": 0.5}}
    spec = Campaign.model_validate({"experiment": "any", "runs": 1, "expect": bounds})
    good = summarise([row(0, 1.0), row(2, 2.0)], {"plant.hold": "last"}, ["error"])
    bad = summarise([row(1, 9.0, completed=False, passed=False)], {"plant.hold": "zero"}, ["error"])
    assert all(check.passed for check in judge_groups(spec, [good]))
    missed = [check.name for check in judge_groups(spec, [good, bad]) if not check.passed]
    assert missed == [f"plant.hold=zero: {name}" for name in ("completed runs", "error.mean", "success_rate")]
