import base64
import json

import numpy as np
import pytest

pytest.importorskip("matplotlib")

from space_robot_report.pages.spreads import MAX_POINTS, spread_figures


def rows_of(count, seed=0):
    """Rows of a campaign; every tenth has not settled, one has not completed."""
    rng = np.random.default_rng(seed)
    rows = []
    for index in range(count):
        settling = None if index % 10 == 3 else float(rng.lognormal())
        numbers = {"base/roll.settling_time": settling, "base/roll.max_error": float(rng.normal() ** 2)}
        totals = {"effort_integral": float(rng.lognormal()), "energy_residual": 1e-15 * rng.random()}
        rows.append({"index": index, "completed": index != 7, **numbers, **totals})
    return rows


def values_of(trace):
    return np.frombuffer(base64.b64decode(trace["y"]["bdata"]), dtype="<f8")


def test_every_run_that_has_the_number_is_a_point_with_its_case():
    """Few runs are all drawn, with the number of their case; those without the number, or not completed, are not."""
    rows = rows_of(60)
    (trace,) = spread_figures({"all runs": rows})["settling_time by axis"]["data"]
    there = [row for row in rows if row["completed"] and row["base/roll.settling_time"] is not None]
    assert values_of(trace).tolist() == [row["base/roll.settling_time"] for row in there]
    assert trace["text"] == [f"case {row['index']}" for row in there]
    assert set(trace["x"]) == {"base/roll"}


def test_many_runs_are_thinned_by_size_and_keep_their_ends_and_quartiles():
    """Of many runs a bounded number is drawn: smallest, largest, quartiles stay, and cases stay with their numbers."""
    rows = rows_of(5000)
    (trace,) = spread_figures({"all runs": rows})["max_error by axis"]["data"]
    values, drawn = np.array([row["base/roll.max_error"] for row in rows if row["completed"]]), values_of(trace)
    assert drawn.size == MAX_POINTS
    assert (drawn.min(), drawn.max()) == (values.min(), values.max())
    np.testing.assert_allclose(np.quantile(drawn, [0.25, 0.5, 0.75]), np.quantile(values, [0.25, 0.5, 0.75]), rtol=0.05)
    cases = [int(text.removeprefix("case ")) for text in trace["text"]]
    assert drawn.tolist() == [rows[case]["base/roll.max_error"] for case in cases]


def test_points_of_the_grid_are_distinguished():
    """Each point of the grid has a box of its own, also for the numbers of whole runs."""
    figures = spread_figures({"law=a": rows_of(20), "law=b": rows_of(20, seed=1)})
    assert [trace["name"] for trace in figures["settling_time by axis"]["data"]] == ["law=a", "law=b"]
    assert [trace["name"] for trace in figures["effort_integral"]["data"]] == ["law=a", "law=b"]


def test_rounding_errors_of_the_plant_are_no_distribution():
    """Residuals of conservation are judged, not drawn; what is drawn can be written as JSON."""
    figures = spread_figures({"all runs": rows_of(20)})
    assert "energy_residual" not in figures
    assert json.dumps(figures, allow_nan=False)
