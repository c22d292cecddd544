"""The rows of a study on disk."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from space_robot_studies.engine import journal
from space_robot_studies.engine.journal import Row, finished_rows, open_journal


def test_rows_are_readable_at_once_and_on_disk_at_the_end(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A row is in the file when ``append`` returns; the disk is waited for once a second, and when the study ends."""
    now, synced = [0.0], list[float]()
    monkeypatch.setattr(journal, "monotonic", lambda: now[0])
    monkeypatch.setattr(os, "fsync", lambda descriptor: synced.append(now[0]))
    with open_journal(tmp_path, {"python": "3"}, 1.0) as rows:
        for index in range(10):
            now[0] = 0.25 * index
            rows.append(Row(index, {"passed": True}))
            assert list(finished_rows(tmp_path)[1]) == list(range(index + 1))
        assert synced == [1.0, 2.0]
    assert synced == [1.0, 2.0, 2.25]
    assert [row.columns for row in finished_rows(tmp_path)[1].values()] == [{"passed": True}] * 10
