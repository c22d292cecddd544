"""The life cycle of running nodes: held, cleaned up, shut down, configured again; nothing of it stays."""

from __future__ import annotations

import gc
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("rclpy")
from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import GetState

from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.run import run_experiment
from space_robot_control.nodes.controller import ControllerNode
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.nodes.managed import bring_up
from tests.support.harness import running_graph
from tests.support.live import call, events, transit
from tests.support.replays import replayed

pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]


@pytest.mark.parametrize("node", ["controller", "simulator"])
def test_a_deactivated_node_holds_and_goes_on_without_a_trace(tmp_path: Path, node: str) -> None:
    """Time stands still while it is inactive; activated again the run ends with the bits of an undisturbed one."""
    plain = tmp_path / "plain" / "run"
    run_experiment(load_experiment("liu2023/fig08"), plain, mode="headless")
    with running_graph(tmp_path / "run", services=True) as robot:
        assert transit(robot, node, Transition.TRANSITION_DEACTIVATE)
        robot.settle()
        held = robot.simulator.tick
        robot.spin_for(0.2)
        assert robot.simulator.tick == held < 160, "the run was over before it could be held"
        assert call(robot, GetState, f"{node}/get_state").current_state.label == "inactive"
        assert transit(robot, node, Transition.TRANSITION_ACTIVATE)
        robot.spin_until(lambda: robot.recorder.complete, "the end of the run")
        robot.recorder.finish("completed")
    assert list(LogReader(tmp_path / "run").messages()) == list(LogReader(plain).messages())


def test_a_simulator_cleaned_up_runs_again_from_the_start(tmp_path: Path) -> None:
    """After deactivate and cleanup nothing of it speaks; configured and activated it gives the whole run, once."""
    plain = tmp_path / "plain" / "run"
    run_experiment(load_experiment("liu2023/fig08"), plain, mode="headless")
    with running_graph(tmp_path / "run", services=True) as robot:
        for transition in (Transition.TRANSITION_DEACTIVATE, Transition.TRANSITION_CLEANUP):
            assert transit(robot, "simulator", transition)
        assert robot.stranger.count_publishers("base/odom") == 0
        assert not transit(robot, "simulator", Transition.TRANSITION_ACTIVATE), "nothing to activate"
        for transition in (Transition.TRANSITION_CONFIGURE, Transition.TRANSITION_ACTIVATE):
            assert transit(robot, "simulator", transition)
        robot.spin_until(lambda: robot.recorder.complete, "the end of the second run")
        robot.recorder.finish("completed")
    logs = sorted(path for path in tmp_path.iterdir() if path.name.startswith("run"))
    assert list(LogReader(logs[-1]).messages()) == list(LogReader(plain).messages())


@pytest.mark.parametrize("node", ["controller", "simulator"])
def test_shutting_a_node_down_ends_the_run(tmp_path: Path, node: str) -> None:
    """All nodes hear it, and the log says whose end it was."""
    with running_graph(tmp_path / "run", realtime=0.001, services=True) as robot:
        robot.spin_until(lambda: robot.simulator.started, "the start")
        assert transit(robot, node, Transition.TRANSITION_ACTIVE_SHUTDOWN)
        robot.spin_until(lambda: robot.recorder.end_reason, "the recorder to hear it")
        assert robot.recorder.end_reason == f"{node}: shut down"


def test_a_node_that_cannot_be_configured_can_try_again(tmp_path: Path) -> None:
    """The transition fails with the error of the law and leaves no topic behind; the next one starts from nothing."""
    with running_graph(tmp_path / "run", roles=("simulator",)) as robot:
        answers: list[Any] = [SpecError("no such inertia", key="gains"), robot.composition.controller()]

        def make_law() -> Any:
            answer = answers.pop(0)
            if isinstance(answer, Exception):
                raise answer
            return answer

        node = ControllerNode(make_law, robot.composition.joint_names, context=robot.context, steered=False)
        with pytest.raises(SpecError, match="no such inertia"):
            bring_up([node])
        assert not node.configured
        assert node.count_publishers("joint_command") == 0
        bring_up([node])
        assert node.active
        assert node.count_publishers("joint_command") == 1
        node.destroy_node()


def test_a_graph_leaves_nothing_of_itself(tmp_path: Path) -> None:
    """With its context a graph's threads are gone, and so its nodes and services, without any garbage collection."""

    def threads_after(name: str) -> int:
        with running_graph(tmp_path / name, services=True) as robot:
            robot.spin_until(lambda: robot.simulator.started, "the start")
        return len(list(Path("/proc/self/task").iterdir()))

    gc.collect()
    gc.disable()
    try:
        # What the first one starts for the whole process stays.
        assert threads_after("one") == threads_after("two") == threads_after("three")
    finally:
        gc.enable()


def test_a_paced_run_without_an_active_controller_runs_in_its_hold(tmp_path: Path) -> None:
    """The periods are missed; activated again the law starts anew, the log says so, and a replay does the same."""
    # The clock is too slow to fire: periods end when the test says so, or a busy machine would decide the outcome.
    with running_graph(
        tmp_path / "run", "controller={law: adaptive}", "duration=5.0", realtime=0.001, services=True
    ) as robot:
        simulator = robot.simulator

        def run_until(tick: int) -> None:
            while simulator.tick < tick:
                robot.spin_until(lambda: simulator.commands.answered, "a command")
                simulator._on_period()

        run_until(3)
        robot.spin_until(lambda: simulator.commands.answered, "the command of tick 3")
        assert transit(robot, "controller", Transition.TRANSITION_DEACTIVATE)
        for _ in range(5):
            simulator._on_period()
            robot.settle()
        assert (simulator.tick, simulator.commands.counts["missed"]) == (8, 4)
        assert transit(robot, "controller", Transition.TRANSITION_ACTIVATE)
        run_until(20)
        robot.spin_until(lambda: simulator.commands.answered, "the last command")
        simulator._on_period()
        assert simulator.end_reason == "completed"
        robot.spin_until(lambda: robot.recorder.end_reason, "the recorder to hear the end")
        robot.settle()
        robot.recorder.finish("completed")
    assert [kind for _, kind, _ in events(list(LogReader(tmp_path / "run").ticks()))] == ["reset"]
    (controller,) = replayed(tmp_path / "run", against="controller").outcomes
    assert controller.first is None
