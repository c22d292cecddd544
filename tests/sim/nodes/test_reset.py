"""~/reset and the life cycle in a run: it always goes on to its end, or the service says why not."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("rclpy")
from rclpy.parameter import Parameter
from std_srvs.srv import Trigger

from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.run import run_experiment
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.nodes.managed import ManagedNode
from tests.chaos.steering import failure_of
from tests.support.harness import RunningGraph, running_graph
from tests.support.replays import replayed

pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]
SHORT, STEPS = "duration=5.0", 20


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> list[Any]:
    """The messages of the run that is not reset."""
    place = tmp_path_factory.mktemp("truth") / "run"
    run_experiment(load_experiment("liu2023/fig08", [SHORT]), place, mode="headless")
    return list(LogReader(place).messages())


def trigger(robot: RunningGraph, name: str) -> Any:
    client = robot.stranger.create_client(Trigger, f"simulator/{name}")
    robot.spin_until(client.service_is_ready, f"service {name}")
    future = client.call_async(Trigger.Request())
    robot.spin_until(future.done, f"an answer of {name}")
    return future.result()


def stand(robot: RunningGraph, tick: int) -> None:
    """Bring the run to a state that has its answer."""
    robot.simulator.pause(True)
    while robot.await_answer() < tick:
        reached = robot.simulator.tick
        robot.simulator.step_once()
        robot.spin_until(lambda reached=reached: robot.simulator.tick > reached, "a step")


def finish(robot: RunningGraph) -> None:
    """Let the run go on to its end."""
    robot.simulator.pause(False)
    robot.spin_until(lambda: robot.recorder.end_reason, "the end of the run")
    robot.spin_until(lambda: robot.recorder.complete, "the last tick")
    robot.recorder.finish("completed")


def managed(robot: RunningGraph, name: str) -> ManagedNode:
    node = robot.nodes[name]
    assert isinstance(node, ManagedNode)
    return node


@pytest.mark.parametrize("ahead", [0, 256])
def test_a_late_reset_while_paused_and_twice_starts_the_run_again(
    ahead: int, tmp_path: Path, undisturbed: list[Any]
) -> None:
    """However much credit the old run had, the new one goes to its end, and both logs are what they should be."""
    with running_graph(tmp_path / "run", SHORT) as robot:
        robot.recorder._ahead = ahead
        stand(robot, STEPS - 3)
        robot.simulator.step_once()
        robot.simulator.step_once()
        robot.simulator.reset()
        robot.simulator.reset()
        robot.settle()
        # A step that was granted for the old run moves nothing in the new one.
        assert (robot.simulator.tick, robot.simulator.paused) == (0, True)
        finish(robot)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["run", "run_reset1"]
    assert list(LogReader(tmp_path / "run_reset1").messages()) == undisturbed
    first = LogReader(tmp_path / "run")
    cut = list(first.messages())
    assert first.end_reason == "reset"
    # The state at which the run was reset may have no answer.
    assert cut == [message for message in undisturbed if message in set(cut)]


def test_a_reset_before_the_first_step_and_after_the_end_moves_nothing(tmp_path: Path, undisturbed: list[Any]) -> None:
    """At tick 0 there is nothing to go back from; a run that is over is refused, with the reason."""
    with running_graph(tmp_path / "run", SHORT) as robot:
        robot.simulator.pause(True)
        assert trigger(robot, "reset").success
        robot.await_answer()
        assert trigger(robot, "reset").success
        finish(robot)
        answer = trigger(robot, "reset")
        assert not answer.success
        assert "the run is over" in answer.message
    assert [path.name for path in tmp_path.iterdir()] == ["run"]
    assert list(LogReader(tmp_path / "run").messages()) == undisturbed


def test_a_controller_configured_anew_keeps_its_tuned_gains_and_says_so(tmp_path: Path) -> None:
    """What was tuned is in force after cleanup and configure; the log has it, and a replay gives the same bits."""
    with running_graph(tmp_path / "run", SHORT, "controller.gains.update=rls") as robot:
        stand(robot, 5)
        controller = managed(robot, "controller")
        (result,) = controller.set_parameters([Parameter("gains.kappa", value=0.5)])
        assert result.successful, result.reason
        controller.trigger_deactivate()
        controller.trigger_cleanup()
        # A state that comes while there is no law is not lost.
        robot.simulator.step_once()
        robot.spin_until(lambda: robot.simulator.tick == 6, "a step")
        controller.trigger_configure()
        controller.trigger_activate()
        assert controller.get_parameter("gains.kappa").value == 0.5
        finish(robot)
    ticks = list(LogReader(tmp_path / "run").ticks())
    found = [(k, event.kind) for k, tick in enumerate(ticks) for event in tick.output.events]
    assert found == [(6, "parameters"), (6, "reset")]
    assert [outcome.first for outcome in replayed(tmp_path / "run").outcomes] == [None, None]


def test_a_simulator_configured_anew_keeps_its_pace_and_waits_for_its_recorder(
    tmp_path: Path, undisturbed: list[Any]
) -> None:
    """The run that was under way ends with the reason reset, and the new one is whole."""
    with running_graph(tmp_path / "run", SHORT, realtime=0.001) as robot:
        simulator = managed(robot, "simulator")
        for _ in range(8):
            robot.await_answer()
            robot.simulator._on_period()
        simulator.set_parameters([Parameter("realtime", value=0.002)])
        simulator.trigger_deactivate()
        simulator.trigger_cleanup()
        simulator.trigger_configure()
        simulator.trigger_activate()
        assert simulator.get_parameter("realtime").value == 0.002
        while robot.simulator.end_reason is None:
            robot.spin_until(lambda: robot.simulator.started and robot.simulator.commands.answered, "an answer")
            robot.simulator._on_period()
        robot.spin_until(lambda: robot.recorder.complete, "the last tick")
        robot.recorder.finish("completed")
    assert LogReader(tmp_path / "run").end_reason == "reset"
    assert list(LogReader(tmp_path / "run_reset1").messages()) == undisturbed


# The third and the fourth stood for ever, or had a log that did not replay, while a reset kept the old credit.
@pytest.mark.parametrize("index", [0, 11, 19, 35])
def test_a_run_goes_to_its_end_whatever_steered_it(index: int) -> None:
    """After any sequence of pause, step, reset, transitions and parameters the run completes with whole logs."""
    assert failure_of(7, index) == ""
