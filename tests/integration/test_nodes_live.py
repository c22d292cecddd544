"""What can be done to running nodes: parameters, the switch, the life cycle; and what the log says of it."""

from __future__ import annotations

import gc
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("rclpy")
from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState, GetState
from rcl_interfaces.srv import DescribeParameters, GetParameters, ListParameters, SetParametersAtomically
from rclpy.parameter import Parameter
from std_srvs.srv import SetBool, Trigger

from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.run import run_experiment
from space_robot_control.nodes.controller import ControllerNode
from space_robot_msgs_py.errors import NonFiniteError, SpecError
from space_robot_msgs_py.interfaces import Command, PlantSample, Tick
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.nodes.managed import bring_up
from tests.support.harness import RunningGraph, running_graph
from tests.support.replays import assert_equal, replayed

pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]
SWITCH = "switch/mini"
UNPLANNED = ("controller.switches=[]", "duration=40.0")


def call(robot: RunningGraph, service: Any, name: str, request: Any = None) -> Any:
    """The answer of a service."""
    client = robot.stranger.create_client(service, name)
    robot.spin_until(client.service_is_ready, f"service {name}")
    future = client.call_async(request or service.Request())
    robot.spin_until(future.done, f"an answer of {name}")
    return future.result()


def set_parameters(robot: RunningGraph, node: str, **values: Any) -> Any:
    """Set parameters of a node at once; ``__`` in a name is a dot."""
    parameters = [Parameter(name.replace("__", "."), value=v).to_parameter_msg() for name, v in values.items()]
    request = SetParametersAtomically.Request(parameters=parameters)
    return call(robot, SetParametersAtomically, f"{node}/set_parameters_atomically", request).result


def get_parameter(robot: RunningGraph, node: str, name: str) -> Any:
    """The value of a parameter."""
    answer = call(robot, GetParameters, f"{node}/get_parameters", GetParameters.Request(names=[name]))
    return Parameter.from_parameter_msg(_named(name, answer.values[0])).value


def _named(name: str, value: Any) -> Any:
    from rcl_interfaces.msg import Parameter as Message

    return Message(name=name, value=value)


def transit(robot: RunningGraph, node: str, transition: int) -> bool:
    """Ask a node for a transition of its life cycle."""
    request = ChangeState.Request(transition=Transition(id=transition))
    return bool(call(robot, ChangeState, f"{node}/change_state", request).success)


def halted(robot: RunningGraph) -> int:
    """Pause the run; the tick at which it stands."""
    call(robot, SetBool, "simulator/pause", SetBool.Request(data=True))
    return robot.await_answer()


def finished(robot: RunningGraph) -> list[Tick]:
    """Let the run go on to its end; its ticks."""
    call(robot, SetBool, "simulator/pause", SetBool.Request(data=False))
    robot.spin_until(lambda: robot.recorder.complete, "the end of the run")
    robot.recorder.finish("completed")
    return list(LogReader(robot.directory).ticks())


def events(ticks: list[Tick]) -> list[tuple[int, str, Any]]:
    """Tick, kind and content of all events of a log."""
    return [(i, e.kind, dict(e.content)) for i, tick in enumerate(ticks) for e in tick.output.events]


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
