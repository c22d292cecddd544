"""The comparison with other engines (``benchmarks.accuracy``): its reference, its robots in MuJoCo, its page."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks import accuracy
from benchmarks.accuracy_page import Row, page
from benchmarks.accuracy_tasks import ROBOTS, drift, error, task, truth
from benchmarks.peers.engines import answer
from tests.support.paths import ROOT


@pytest.mark.parametrize("name", ["mini", "ANYmal"])
def test_plant_and_mujoco_end_where_the_reference_does(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """An arm and a tree: equal to rounding for this plant and close for MuJoCo, which keep momentum as well."""
    pytest.importorskip("mujoco")
    monkeypatch.setattr(accuracy, "ROUNDS", 1)
    one = task(name, periods=3)
    rows = {row.name: row for row in accuracy.table(one, None)}
    assert list(rows)[:-1] == list(accuracy.OURS)
    assert all(row.error < 1e-13 and row.drift < 1e-13 for row in rows.values())
    found = answer({"task": one.message, **accuracy.THEIRS["MuJoCo, RK4 1 ms"]})
    q = np.array(found["qpos"])
    q[3:7] = np.roll(q[3:7], -1)
    v = np.array(found["qvel"])
    v[:3] = accuracy.turned_back(q[3:7], v[:3])
    assert error(q, truth(one)[0]) < 1e-13
    assert drift(one, q, v) < 1e-12
    assert error(q, one.q) > 1e-3


def test_the_page_has_a_table_for_every_robot() -> None:
    """Rows as measured, the machine and what was not there; the page in docs is such a page."""
    text = page({name: [Row("one", 12.4, 1.23e-9, 4e-15), Row("two", None, 0.0, 0.0)] for name in ROBOTS}, {}, 5.0)
    assert text.count("| one | 12 | 1.2e-09 | 4.0e-15 |\n| two |  | 0.0e+00 | 0.0e+00 |\n") == len(ROBOTS)
    assert "Basilisk not installable here" in text
    shown = (ROOT / "docs" / "accuracy.md").read_text(encoding="utf-8")
    for name in ROBOTS:
        rows = shown.partition(f"\n## {name}\n")[2].partition("\n## ")[0]
        assert [rows.count(f"| {engine} |") for engine in (*accuracy.OURS, *accuracy.THEIRS)] == [1] * 7
    assert shown.partition("\nMachine: ")[0] == text.partition("\nMachine: ")[0]
    assert shown.partition("\n## What to")[2] == text.partition("\n## What to")[2]
