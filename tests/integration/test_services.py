"""Pause, step, reset and pace: the run is steered without changing what it computes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("rclpy")
from rclpy.parameter import Parameter
from std_srvs.srv import SetBool, Trigger

from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.run import run_experiment
from space_robot_msgs_py.log.reader import LogReader
from tests.support.harness import RunningGraph, running_graph

pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]


def call(robot: RunningGraph, service: Any, name: str, request: Any) -> Any:
    client = robot.stranger.create_client(service, f"simulator/{name}")
    robot.spin_until(client.service_is_ready, f"service {name}")
    future = client.call_async(request)
    robot.spin_until(future.done, f"an answer of {name}")
    return future.result()


def pause(robot: RunningGraph, wanted: bool) -> Any:
    return call(robot, SetBool, "pause", SetBool.Request(data=wanted))


def trigger(robot: RunningGraph, name: str) -> Any:
    return call(robot, Trigger, name, Trigger.Request())


def test_a_paused_run_takes_single_steps_and_ends_with_the_same_bits(tmp_path: Path) -> None:
    """Pause stops at a tick, step advances one, resume finishes; the log equals an undisturbed one."""
    run_experiment(load_experiment("liu2023/fig08"), tmp_path / "truth" / "run", mode="headless")
    with running_graph(tmp_path / "run") as robot:
        assert pause(robot, True).success
        stopped = robot.await_answer()
        assert stopped < robot.composition.experiment.steps, "the run was over before it could be paused"
        robot.spin_for(0.1)
        assert robot.simulator.tick == stopped
        assert trigger(robot, "step").success
        robot.spin_until(lambda: robot.simulator.tick == stopped + 1, "one step")
        robot.spin_for(0.1)
        assert robot.simulator.tick == stopped + 1
        assert pause(robot, False).success
        robot.spin_until(lambda: robot.recorder.complete, "the end of the run")
        robot.recorder.finish("completed")
    truth = list(LogReader(tmp_path / "truth" / "run").messages())
    assert list(LogReader(tmp_path / "run").messages()) == truth


def test_a_step_is_as_many_periods_as_the_parameter_says(tmp_path: Path) -> None:
    """`step_count` is dynamic; what is no number of steps is refused, with the reason."""
    with running_graph(tmp_path / "run", services=True) as robot:
        assert pause(robot, True).success
        stopped = robot.await_answer()

        def count(value: int) -> Any:
            return robot.simulator.set_parameters([Parameter("step_count", value=value)])[0]

        assert count(7).successful
        assert "7 steps granted" in trigger(robot, "step").message
        robot.spin_until(lambda: robot.simulator.tick == stopped + 7, "seven steps")
        robot.settle()
        assert robot.simulator.tick == stopped + 7
        refused = count(0)
        assert not refused.successful
        assert "1 to 100000" in refused.reason


def test_step_is_refused_while_running(tmp_path: Path) -> None:
    """A step without a pause changes nothing and says what to do."""
    with running_graph(tmp_path / "run", roles=("recorder", "guidance", "simulator")) as robot:
        answer = trigger(robot, "step")
        assert not answer.success
        assert "pause" in answer.message


def test_reset_starts_the_same_run_again_in_a_log_of_its_own(tmp_path: Path) -> None:
    """After a reset in mid-run the first log ends with that reason and the second holds the whole run."""
    run_experiment(load_experiment("liu2023/fig08"), tmp_path / "truth" / "run", mode="headless")
    with running_graph(tmp_path / "run") as robot:
        pause(robot, True)
        reached = robot.simulator.tick
        for step in range(3):
            trigger(robot, "step")
            robot.spin_until(lambda goal=reached + step + 1: robot.simulator.tick == goal, "a step")
        assert trigger(robot, "reset").success
        assert pause(robot, False).success
        robot.spin_until(lambda: robot.recorder.complete, "the end of the second run")
        robot.recorder.finish("completed")
    truth = list(LogReader(tmp_path / "truth" / "run").messages())
    assert list(LogReader(tmp_path / "run_reset1").messages()) == truth
    first = LogReader(tmp_path / "run")
    assert first.end_reason == "reset"
    cut = list(first.messages())
    assert cut == truth[: len(cut)]


def test_a_paced_run_follows_the_steady_clock_and_counts_what_is_missing(tmp_path: Path) -> None:
    """Without any controller a paced run goes on in its hold, counts every period, and its log is complete."""
    with running_graph(
        tmp_path / "run", "duration=2.0", roles=("recorder", "guidance", "simulator"), realtime=20.0
    ) as robot:
        robot.spin_until(lambda: robot.simulator.end_reason is not None, "the end of the run")
        assert robot.simulator.end_reason == "completed"
        assert robot.simulator.commands.counts["missed"] == 9
        robot.settle()
        robot.recorder.finish("completed")
    states = [stamp for topic, stamp, _ in LogReader(tmp_path / "run").messages() if topic == "base/odom"]
    assert states == [250_000_000 * tick for tick in range(9)]


def test_a_paced_run_with_a_prompt_controller_equals_the_lock_step_run(tmp_path: Path) -> None:
    """Where every command is there when its period ends, pacing gives the bits of lock-step."""
    run_experiment(load_experiment("liu2023/fig08", ["duration=5.0"]), tmp_path / "truth" / "run", mode="headless")
    # The clock is too slow to fire: periods end when the test says so, or a busy machine would decide the outcome.
    with running_graph(tmp_path / "run", "duration=5.0", realtime=0.001) as robot:
        while robot.simulator.end_reason is None:
            tick = robot.simulator.tick
            robot.spin_until(lambda: robot.simulator.commands.answered, f"the command of tick {tick}")
            robot.simulator._on_period()
        assert robot.simulator.tick == 20
        robot.spin_until(lambda: robot.recorder.complete, "the end of the run")
        assert robot.simulator.commands.counts["missed"] == 0
        robot.recorder.finish("completed")
    truth = list(LogReader(tmp_path / "truth" / "run").messages())
    assert list(LogReader(tmp_path / "run").messages()) == truth
