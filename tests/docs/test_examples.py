"""The examples run as they are, and are short."""

from __future__ import annotations

import re
import runpy
import sys
from pathlib import Path

import pytest

from tests.support.paths import ROOT

MAX_LINES = 60
SCRIPTS = sorted((ROOT / "examples").glob("*.py"))
# What each needs beyond the installation, and something that it says or leaves.
NEEDS = {
    "gym_random_search.py": ("gymnasium", "reward -"),
    "monte_carlo.py": ("pyarrow", "of 8 runs succeed"),
    "own_robot.py": ("", "completed"),
    "pid_law.py": ("", "ki = 0.02: yaw is off by 0."),
    "replay_diff.py": ("", "as recorded: equal\nwith another gain: different"),
    "run_and_plot.py": ("matplotlib", "joint4 ends at"),
    "sweep_gains.py": ("pyarrow", "controller.gains.kappa"),
    "tune_gain.py": ("scipy", "bandwidth"),
}
# Run in other ways: a law by the page of laws, a node by its test.
OTHERS = {"compiled_law.py", "my_law.py", "rclpy_controller.py", "test_rclpy_controller.py"}


def test_there_are_ten_examples_and_all_are_known() -> None:
    """Each under 60 lines, with a docstring that says how it is run, and on the page."""
    assert {path.name for path in SCRIPTS} == NEEDS.keys() | OTHERS
    assert len(SCRIPTS) >= 10
    page = (ROOT / "docs" / "examples.md").read_text(encoding="utf-8")
    for path in SCRIPTS:
        text = path.read_text(encoding="utf-8")
        assert text.count("\n") < MAX_LINES, path.name
        assert f"`examples/{path.name}`" in page, path.name
        assert re.search(r"python examples/|space-robot |pytest examples/", text), path.name


@pytest.mark.xdist_group("campaign")
@pytest.mark.parametrize("name", NEEDS)
def test_an_example_runs(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """As a script, in an empty folder; it says what it is to say."""
    package, said = NEEDS[name]
    if package:
        pytest.importorskip(package)
    if package == "matplotlib":
        monkeypatch.setenv("MPLBACKEND", "Agg")
    monkeypatch.chdir(tmp_path)
    main = sys.modules["__main__"]
    try:
        runpy.run_path(str(ROOT / "examples" / name), run_name="__main__")
    finally:
        sys.modules["__main__"] = main
    assert said in capsys.readouterr().out


@pytest.mark.ros
@pytest.mark.xdist_group("graph")
def test_the_node_passes_its_own_test(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """The test in examples/, with the fixture of the plugin."""
    pytest.importorskip("rclpy")
    monkeypatch.syspath_prepend(str(ROOT / "examples"))
    test = runpy.run_path(str(ROOT / "examples" / "test_rclpy_controller.py"))
    test["test_the_controller_brings_the_robot_to_its_target"](request.getfixturevalue("space_robot_graph"))
