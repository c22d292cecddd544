"""What the plugin of pytest gives to a test, used as one would."""

from __future__ import annotations

from collections.abc import Callable
from importlib.metadata import entry_points
from pathlib import Path

import numpy as np
import pytest

import space_robot as sr

Factory = Callable[..., sr.Run]
Graphs = Callable[..., sr.OpenGraph]
NAME, SHORT = "liu2023/fig08", {"duration": 12.0, "expect": {}}
JET = {"faults": [{"kind": "wrench_pulse", "torque": [0, 0, 0.1], "at": 8.0, "for": 1.0, "name": "jet"}]}


@pytest.fixture(scope="module")
def run() -> sr.Run:
    """A run with an event."""
    return sr.run(NAME, SHORT | JET)


def test_the_plugin_is_installed() -> None:
    """Pytest finds it in every environment that has the project."""
    (point,) = (one for one in entry_points(group="pytest11") if one.name == "space_robot")
    assert point.value == "space_robot_bringup.pytest_plugin"


def test_runs_of_a_test_have_their_logs_in_its_folder(space_robot_run: Factory, tmp_path: Path) -> None:
    """One each; the arguments are those of ``run``."""
    runs = [space_robot_run(NAME, {"duration": 1.0}), space_robot_run(NAME, duration=1.0)]
    assert [run.directory.parent for run in runs] == [tmp_path, tmp_path]
    assert runs[0].log.path.read_bytes() == runs[1].log.path.read_bytes()
    assert space_robot_run(NAME, duration=0.5, out=tmp_path / "mine").directory == tmp_path / "mine"


def test_tracking_is_asserted(run: sr.Run) -> None:
    """What holds passes, what does not says which error, how large and when."""
    sr.assert_tracking(run, attitude=0.2, joints=0.2)
    with pytest.raises(AssertionError, match=r"error\.attitude.*at \d+(\.\d+)? s \(tick \d+\)"):
        sr.assert_tracking(run, attitude=1e-6)
    with pytest.raises(AssertionError, match=r"error\.joints"):
        sr.assert_tracking(str(run.directory), attitude=0.2, joints=1e-9, after=2.0)
    with pytest.raises(sr.SpaceRobotError, match=r"attitude, joints or position"):
        sr.assert_tracking(run)


def test_events_are_asserted(run: sr.Run) -> None:
    """How often each happened; a name that means nothing is an error, not a failure."""
    sr.assert_events(run, {"jet begins": 1, "jet ends": 1})
    with pytest.raises(AssertionError, match=r"events\.jet begins"):
        sr.assert_events(run, {"jet begins": 0})
    with pytest.raises(AssertionError, match=r"events\.jet begins"):
        sr.assert_events(run, {"jet begins": 2})
    with pytest.raises(sr.SpaceRobotError, match="jte begins"):
        sr.assert_events(run, {"jte begins": 1})


def test_conservation_is_asserted(run: sr.Run) -> None:
    """By the bounds of every run, or by tighter ones."""
    sr.assert_conserved(run)
    with pytest.raises(AssertionError, match=r"momentum_residual is .*wanted <= 0"):
        sr.assert_conserved(run, momentum=0.0)
    with pytest.raises(AssertionError, match="energy_residual"):
        sr.assert_conserved(run, momentum=1.0, energy=0.0)


@pytest.mark.ros
@pytest.mark.xdist_group("graph")
def test_a_graph_is_the_run(space_robot_graph: Graphs) -> None:
    """Opened, spun and finished, it leaves the log of a headless run; a role may be left out."""
    graph = space_robot_graph(NAME, {"duration": 2.0})
    graph.spin_until(lambda: graph.tick >= 2, "the second tick")
    run = graph.finish()
    assert run.reason == "completed"
    np.testing.assert_array_equal(run.arrays.base.quaternion, sr.run(NAME, {"duration": 2.0}).arrays.base.quaternion)
    assert set(graph.nodes) == {"recorder", "guidance", "controller", "simulator"}


@pytest.mark.ros
@pytest.mark.xdist_group("graph")
def test_a_graph_that_waits_says_for_what(space_robot_graph: Graphs) -> None:
    """Without a controller the run cannot go on; a role that there is not is refused."""
    graph = space_robot_graph(NAME, SHORT, without=["controller"])
    with pytest.raises(sr.SpaceRobotError, match=r"waited 0\.2 s for the end of the run; got 0"):
        graph.finish(timeout=0.2)
    with pytest.raises(sr.SpaceRobotError, match=r"^without: no node .*accepted: guidance, controller"):
        space_robot_graph(NAME, SHORT, without=["simulator"])
