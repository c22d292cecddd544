"""Where a study goes is looked at before anything else is done."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("scipy")
pytest.importorskip("pyarrow")

from space_robot_msgs_py.errors import InputFileError, SpecError
from space_robot_studies.campaign.campaign import run_campaign
from space_robot_studies.compare.compare import compare
from space_robot_studies.engine.local_workers import LocalWorkers
from space_robot_studies.reproduce.reproduction import reproduce


def one_campaign(place: Path, **options: Any) -> None:
    run_campaign("fig08_dispersed", place, **options)


def a_comparison(place: Path, **options: Any) -> None:
    compare(["compare_mini"], place, **options)


def a_reproduction(place: Path, **options: Any) -> None:
    reproduce("liu2023", place, figures=["8"], **options)


@pytest.mark.parametrize("resume", [False, True])
@pytest.mark.parametrize("below", ["", "study", "deep/study"])
@pytest.mark.parametrize("study", [one_campaign, a_comparison, a_reproduction])
def test_a_file_in_the_place_of_a_study_is_refused_before_a_worker_starts(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, study: Callable[..., None], below: str, resume: bool
) -> None:
    """A directory that is a file, or would be below one, is one error with ``--out``; no process was started."""
    started: list[object] = []
    monkeypatch.setattr(LocalWorkers, "__init__", lambda self, *arguments, **options: started.append(self))
    precious = tmp_path / "precious"
    precious.write_text("years")
    with pytest.raises((SpecError, InputFileError), match=r"^--out: is (a file|below the file)") as caught:
        study(precious / below, resume=resume)
    assert str(precious) in str(caught.value)
    assert not started
    assert precious.read_text() == "years"
    assert list(tmp_path.iterdir()) == [precious]
