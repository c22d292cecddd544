"""What can be done to running nodes: parameters, the switch, the life cycle; and what the log says of it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("rclpy")
from rcl_interfaces.srv import DescribeParameters, ListParameters
from std_srvs.srv import Trigger

from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.run import run_experiment
from space_robot_msgs_py.errors import NonFiniteError
from space_robot_msgs_py.interfaces import Command, PlantSample, Tick
from space_robot_msgs_py.log.reader import LogReader
from tests.support.harness import running_graph
from tests.support.live import call, events, finished, get_parameter, halted, set_parameters
from tests.support.replays import assert_equal

pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]
SWITCH = "switch/mini"
UNPLANNED = ("controller.switches=[]", "duration=40.0")


def test_every_node_shows_what_it_runs_with(tmp_path: Path) -> None:
    """The resolved experiment is there, described and read-only, but for the dynamic gains."""
    with running_graph(tmp_path / "run", "controller.gains.kappa=0.5", services=True) as robot:
        wanted = {
            "controller": {"law": "adaptive", "gains.kappa": 0.5, "gains.update": "none", "control_period": 0.25},
            "simulator": {"plant.delay_periods": 0, "seed": 0, "realtime": 0.0, "robot": "mini"},
            "guidance": {"reference.kind": "step", "reference.attitude_deg": [10.0, 0.0, 0.0]},
            "recorder": {"duration": 40.0},
        }
        for node, values in wanted.items():
            names = call(robot, ListParameters, f"{node}/list_parameters").result.names
            assert values.keys() <= set(names)
            for name, value in values.items():
                found = get_parameter(robot, node, name)
                assert (list(found) if isinstance(value, list) else found) == value, name
        names = ["gains.kappa", "gains.update", "gains.lambda.joints"]
        request = DescribeParameters.Request(names=names)
        kappa, update, rate = call(robot, DescribeParameters, "controller/describe_parameters", request).descriptors
        assert (kappa.read_only, update.read_only, rate.read_only) == (False, True, False)
        assert "K_D" in kappa.description
        assert kappa.floating_point_range[0].from_value == 0.0
        refused = set_parameters(robot, "controller", gains__update="rls")
        assert not refused.successful
        assert "read-only" in refused.reason


def test_a_gain_changed_during_the_run_acts_at_a_tick_and_is_in_the_log(tmp_path: Path) -> None:
    """The log has the event at the first command of the new gain, plain bits before it, and a replay repeats it all."""
    plain = tmp_path / "plain" / "run"
    run_experiment(load_experiment("liu2023/fig08"), plain, mode="headless")
    with running_graph(tmp_path / "run", services=True) as robot:
        stopped = halted(robot)
        assert stopped < 100, "the run was too far before it could be paused"
        assert set_parameters(robot, "controller", gains__kappa=0.3, gains__lambda__joints=2).successful
        assert get_parameter(robot, "controller", "gains.kappa") == 0.3
        ticks = finished(robot)
    changed = {"values": {"gains.kappa": 0.3, "gains.lambda.joints": 2}}
    # The state at which the run stands was answered before it was asked.
    assert events(ticks) == [(stopped + 1, "parameters", changed)]
    same = [a.output.command.u.tobytes() == b.output.command.u.tobytes() for a, b in _pairs(ticks, plain)]
    assert all(same[: stopped + 1])
    assert not same[stopped + 1]
    assert_equal(tmp_path / "run")


@pytest.mark.parametrize(
    ("values", "why"),
    [
        ({"gains__kappa": -1.0}, "out of range"),
        ({"gains__kappa": 0.0}, "greater than 0"),
        ({"gains__lambda__joints": [1.0, 2.0]}, "joints"),
        ({"gains__kappa": 0.5, "gains__lambda__joints": "nonsense"}, "gains.lambda.joints"),
    ],
)
def test_a_refused_change_says_why_and_changes_nothing(tmp_path: Path, values: dict[str, Any], why: str) -> None:
    """The reason is the law's own error; the run ends with the bits of an undisturbed one."""
    plain = tmp_path / "plain" / "run"
    run_experiment(load_experiment("liu2023/fig08"), plain, mode="headless")
    with running_graph(tmp_path / "run", services=True) as robot:
        halted(robot)
        answer = set_parameters(robot, "controller", **values)
        assert not answer.successful
        assert why in answer.reason
        assert get_parameter(robot, "controller", "gains.kappa") == 1.0
        finished(robot)
    assert list(LogReader(tmp_path / "run").messages()) == list(LogReader(plain).messages())


def test_the_switch_service_takes_the_laws_in_turn(tmp_path: Path) -> None:
    """Each call hands over to the next law; the log has it, and equals that of a file with these switches."""
    with running_graph(tmp_path / "run", *UNPLANNED, experiment=SWITCH, services=True) as robot:
        stopped = halted(robot)
        assert call(robot, Trigger, "controller/switch").success
        call(robot, Trigger, "simulator/step")
        robot.spin_until(lambda: robot.simulator.tick == stopped + 1, "the step")
        robot.spin_until(lambda: get_parameter(robot, "controller", "active_law") == "ntsmc", "the new law's name")
        assert set_parameters(robot, "controller", active_law="mfac").successful
        assert not set_parameters(robot, "controller", active_law="pd").successful
        ticks = finished(robot)
    expected = [("adaptive", "ntsmc"), ("ntsmc", "mfac")]
    assert events(ticks) == [(stopped + 1 + i, "switch", {"from": a, "to": b}) for i, (a, b) in enumerate(expected)]
    times = [0.25 * (stopped + 1 + i) for i in range(2)]
    plan = f"controller.switches=[{{time: {times[0]}, to: ntsmc}}, {{time: {times[1]}, to: mfac}}]"
    planned = tmp_path / "planned" / "run"
    run_experiment(load_experiment(SWITCH, [UNPLANNED[1], plan]), planned, mode="headless")
    assert list(LogReader(tmp_path / "run").messages()) == list(LogReader(planned).messages())
    assert_equal(tmp_path / "run")


def test_the_pace_can_be_changed_during_the_run(tmp_path: Path) -> None:
    """A run that would take half a day ends at once; what is no pace is refused."""
    alone = ("recorder", "guidance", "simulator")
    with running_graph(tmp_path / "run", roles=alone, realtime=1e-3, services=True) as robot:
        robot.spin_until(lambda: robot.simulator.started, "the start")
        for wrong in (0.0, 0, -1.0, "fast", float("nan"), True):
            assert not set_parameters(robot, "simulator", realtime=wrong).successful
        assert set_parameters(robot, "simulator", realtime=1000.0).successful
        robot.spin_until(lambda: robot.simulator.end_reason, "the end of the run")
        assert robot.simulator.end_reason == "completed"


def test_a_plant_failure_in_a_paced_run_reaches_every_node(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The run ends for all nodes with the reason, as in lock-step; no traceback out of a timer."""

    def fail(command: Command | None) -> PlantSample:
        raise NonFiniteError("not finite", key="state.joint_velocity")

    with running_graph(tmp_path / "run", realtime=20.0) as robot:
        robot.spin_until(lambda: robot.simulator.tick > 1, "a run")
        monkeypatch.setattr(robot.simulator._plant, "step", fail)
        robot.spin_until(lambda: robot.recorder.end_reason, "the recorder to hear of the failure")
        reason = "simulator: state.joint_velocity: not finite"
        robot.spin_until(lambda: robot.nodes["controller"].end_reason == reason, "the controller to hear it too")
        assert robot.recorder.end_reason == reason


def _pairs(ticks: list[Tick], other: Path) -> list[tuple[Tick, Tick]]:
    return list(zip(ticks, LogReader(other).ticks(), strict=True))
