"""A law that fails costs one row of its campaign, whatever it does."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

pq = pytest.importorskip("pyarrow.parquet")
pytest.importorskip("scipy")
from tests.support.campaigns import (  # noqa: E402
    LAWS,
    REASONS,
    finished,
    reasons,
    rows,
    run_in,
    without,
    write,
)
from tests.support.follow import DEADLINE, ended  # noqa: E402
from tests.support.forks import fork_main  # noqa: E402

pytestmark = pytest.mark.xdist_group("campaign")
LIMIT = 0.5


def test_a_failing_law_costs_one_row_of_its_campaign(tmp_path: Path) -> None:
    """A law that gives up, raises, exits, kills its process, loops or waits for ever costs one row with the reason."""
    result = run_in(tmp_path, "bad", LAWS, workers=2, time_limit=LIMIT)
    assert (result.end_reason, result.passed, result.lost) == ("completed", False, 2)
    assert reasons(tmp_path / "bad") == REASONS
    table = rows(tmp_path / "bad")
    assert [row["index"] for row in table if row["completed"]] == [0, 8]
    gives_up = table[1]
    assert gives_up["ticks"] == 2
    assert gives_up["base/roll.max_error"] is not None
    assert sorted(path.name for path in (tmp_path / "bad" / "runs").iterdir()) == ["000001", "000002", "000003"]
    journal = [json.loads(line) for line in (tmp_path / "bad" / "rows.jsonl").read_text().splitlines()[1:]]
    assert "KeyError" in next(row["trace"] for row in journal if row["key"] == 2)
    assert {row["key"] for row in journal if row["lost"]} == {4, 5}
    assert {row["key"]: row["time_limit"] for row in journal if row["time_limit"]} == {6: LIMIT, 7: LIMIT}


def test_a_resumed_campaign_runs_again_what_may_end_otherwise(tmp_path: Path) -> None:
    """Lost runs are run again, those ended by a limit only under a larger one, all others never."""
    run_in(tmp_path, "out", without("leaves", "waits"), workers=2, time_limit=LIMIT)
    for limit, again in ((LIMIT, [4]), (LIMIT + 0.1, [4, 5])):
        before = finished(tmp_path / "out")
        run_in(tmp_path, "out", without("leaves", "waits"), workers=2, time_limit=limit, resume=True)
        lines = (tmp_path / "out" / "rows.jsonl").read_text().splitlines()[1 + before :]
        assert sorted(json.loads(line)["key"] for line in lines) == again


def test_output_of_a_law_stays_out_of_the_json(tmp_path: Path) -> None:
    """`--json` prints one object, whatever the laws of the runs say."""
    path = write(tmp_path, LAWS[: LAWS.index("    fine:")] + "    talks: tests.support.laws:Talks\n")
    command = ["campaign", str(path), "--json", "--out", str(tmp_path / "out")]
    with ended([fork_main("space_robot_cli.main", *command)]) as (tool,):
        out, err = tool.communicate(DEADLINE)
    assert json.loads(out)["done"] == 1
    assert "hear me" in err
