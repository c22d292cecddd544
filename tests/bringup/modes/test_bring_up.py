"""A graph that cannot be brought up leaves nothing behind but a log that says why."""

from __future__ import annotations

from pathlib import Path
from time import monotonic

import pytest

pytest.importorskip("rclpy")

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from space_robot_bringup.compose.composition import Composition, compose
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.context import private_context
from space_robot_bringup.modes.graph import make_graph
from space_robot_bringup.modes.signals import Interrupted
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.log.run_directory import RunDirectory
from space_robot_sim.nodes.simulator import SimulatorNode

SECONDS = 10.0


@pytest.mark.ros
@pytest.mark.xdist_group("graph")
@pytest.mark.parametrize(
    ("owner", "method"),
    [(Composition, "reference"), (SimulatorNode, "configure"), (SimulatorNode, "activate")],
    ids=["made", "configured", "activated"],
)
@pytest.mark.parametrize(
    ("error", "reason"),
    [
        (SpecError("no more memory", key="plant"), "not started: plant: no more memory"),
        (Interrupted("timeout"), "timeout"),
    ],
    ids=["error", "interrupted"],
)
def test_a_graph_that_does_not_come_up_closes_its_log_and_its_nodes(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    owner: type,
    method: str,
    error: BaseException,
    reason: str,
) -> None:
    """Whatever fails while nodes are made or brought up is raised; the log has its reason, and no node is left."""
    composition = compose(load_experiment("liu2023/fig08", ["duration=5.0"]))

    def fails(self: object) -> None:
        raise error

    with private_context() as context, monkeypatch.context() as patch:
        patch.setattr(owner, method, fails)
        # Kept: what is caught holds every object on its way.
        with pytest.raises(type(error)) as caught, RunDirectory(tmp_path / "run") as directory:
            make_graph(composition, directory, context=context)
        looker, executor = Node("looker", context=context), SingleThreadedExecutor(context=context)
        deadline = monotonic() + SECONDS
        while (names := looker.get_node_names()) != ["looker"] and monotonic() < deadline:
            rclpy.spin_once(looker, executor=executor, timeout_sec=0.05)
        assert names == ["looker"], f"nodes that are still there after {SECONDS:g} s"
        looker.destroy_node()
    assert caught.value is error
    assert LogReader(tmp_path / "run").end_reason == reason
    assert sum(1 for _ in LogReader(tmp_path / "run").stamps()) == 0
