"""Wherever rotations of the base are shown, it is said what the numbers are."""

from __future__ import annotations

from html import escape
from pathlib import Path

import numpy as np
import pytest

import space_robot as sr
from space_robot_bringup.judge.metrics import ROTATIONS
from space_robot_cli.render.run import verdict
from space_robot_cli.terminal import PlainConsole
from space_robot_description.rotations import EULER

pytest.importorskip("plotly")
pyplot = pytest.importorskip("matplotlib.pyplot")
from space_robot_report.pages.log_report import write_log_report  # noqa: E402

TARGET = {"kind": "step", "attitude_deg": [5.0, -5.0, 10.0]}


@pytest.fixture(scope="module")
def run() -> sr.Run:
    """A base that is to turn about several axes."""
    return sr.run("liu2023/fig08", {"reference": TARGET, "settling_bands": {}, "expect": {}, "duration": 1.0})


def test_travel_is_a_rotation_vector(run: sr.Run) -> None:
    """What is not the Euler angles of the target, and has the angle of the turn as its length."""
    assert run.metrics is not None
    travel = np.array([axis.travel for axis in run.metrics.axes[:3]])
    quaternion = run.arrays.reference.base.quaternion[-1]
    angle = np.degrees(2.0 * np.arccos(abs(quaternion[3])))
    np.testing.assert_allclose(np.linalg.norm(travel), angle, rtol=1e-9)
    assert not np.allclose(np.abs(travel), [5.0, 5.0, 10.0], atol=0.1)


def test_tables_and_pages_say_so(run: sr.Run, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The command line, a notebook and the page of a run, in the same words."""
    verdict(PlainConsole(width=200), run.experiment, "headless", run.result, 1.0)
    assert ROTATIONS in capsys.readouterr().out
    assert escape(ROTATIONS) in run._repr_html_()
    write_log_report(run.directory, tmp_path / "page.html")
    page = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert "rotation vector from the reference to the base" in page
    assert f"Base attitude, {EULER} [deg]" in page


def test_the_figure_says_so(run: sr.Run) -> None:
    """The panel of the attitude is that of Euler angles."""
    figure = run.plot()
    try:
        assert EULER in figure.axes[0].get_title(loc="left")
    finally:
        pyplot.close(figure)
