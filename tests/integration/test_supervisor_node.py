"""The supervisor on the live graph: services of the ground, its life cycle, a reset, a paced run."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("rclpy")
from std_srvs.srv import SetBool, Trigger

from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.hooks import roles_of
from space_robot_bringup.modes.run import run_experiment
from space_robot_bringup.nodes.process import main
from space_robot_bringup.replay.golden import update_reference
from space_robot_bringup.replay.recording import open_recording
from space_robot_bringup.replay.replay import ReplayOptions, replay
from space_robot_msgs_py.codec.codecs import SupervisionCodec
from space_robot_msgs_py.interfaces import Supervision
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.nodes.managed import ManagedNode
from space_robot_msgs_py.topics import SUPERVISOR_MODE
from tests.support.harness import RunningGraph, running_graph
from tests.support.replays import but_for_publishers

pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]
ROLES = roles_of(supervised=True)
WATCHED = ("supervision=mini_basic", "duration=10.0")


def call(robot: RunningGraph, name: str, kind: Any = Trigger, request: Any = None) -> Any:
    """The answer of a service."""
    client = robot.stranger.create_client(kind, name)
    robot.spin_until(client.service_is_ready, f"service {name}")
    future = client.call_async(request or kind.Request())
    robot.spin_until(future.done, f"an answer of {name}")
    return future.result()


def pause(robot: RunningGraph, wanted: bool) -> int:
    """Stop or go on; the tick."""
    call(robot, "simulator/pause", SetBool, SetBool.Request(data=wanted))
    return robot.await_answer() if wanted else -1


def finish(robot: RunningGraph) -> None:
    """To the end of the log."""
    robot.spin_until(lambda: robot.recorder.complete, "the end of the run")
    robot.recorder.finish("completed")


def commands(log: Path) -> list[tuple[int, str, str]]:
    """(tick, command, accepted or refused) of a log."""
    found = [
        (k, one) for k, tick in enumerate(LogReader(log).ticks()) if tick.supervision for one in tick.supervision.events
    ]
    return [(k, dict(one.values)["command"], one.message) for k, one in found if one.name == "command"]


def test_commands_of_the_ground_act_at_a_tick_and_replay_repeats_them(tmp_path: Path) -> None:
    """Accepted and refused are answered with the reason, are events of the next tick, and every side replays equal."""
    with running_graph(tmp_path / "run", *WATCHED, roles=ROLES) as robot:
        tick = pause(robot, True)
        answer = call(robot, "supervisor/safe")
        assert answer.success
        assert "SAFE" in answer.message
        again = call(robot, "supervisor/safe")
        assert not again.success
        assert "in SAFE already" in again.message
        pause(robot, False)
        finish(robot)
    assert commands(tmp_path / "run") == [(tick + 1, "safe", "accepted"), (tick + 1, "safe", "refused")]
    replayed = replay(tmp_path / "run", ReplayOptions())
    assert len(replayed.outcomes) == 3
    assert replayed.equal, [one.comparison.first for one in replayed.outcomes]
    before = (tmp_path / "run" / "run_0.mcap").read_bytes()
    assert not update_reference(open_recording(tmp_path / "run"))
    assert (tmp_path / "run" / "run_0.mcap").read_bytes() == before


def test_a_command_equals_its_schedule(tmp_path: Path) -> None:
    """But for who gave it, the run is that of a schedule with the command at that tick: the same states and modes."""
    with running_graph(tmp_path / "run", *WATCHED, roles=ROLES) as robot:
        tick = pause(robot, True)
        assert call(robot, "supervisor/hold").success
        pause(robot, False)
        finish(robot)
    table = load_experiment("liu2023/fig08", WATCHED).supervision
    assert table is not None
    data = table.model_dump(mode="json", by_alias=True) | {"schedule": [{"at": 0.25 * (tick + 1), "do": "hold"}]}
    run_experiment(
        load_experiment("liu2023/fig08", {"supervision": data, "duration": 10.0}), tmp_path / "planned", mode="headless"
    )
    pairs = zip(LogReader(tmp_path / "run").ticks(), LogReader(tmp_path / "planned").ticks(), strict=True)
    for one, other in pairs:
        assert one.sample.state.q.tobytes() == other.sample.state.q.tobytes()
        assert one.supervision is not None
        assert other.supervision is not None
        assert one.supervision.mode == other.supervision.mode


def test_an_inactive_supervisor_holds_a_lock_step_run_and_changes_no_bit(tmp_path: Path) -> None:
    """Nothing is answered and no command taken while it is inactive; the log is that of an undisturbed run."""
    run_experiment(load_experiment("liu2023/fig08", WATCHED), tmp_path / "truth" / "run", mode="headless")
    with running_graph(tmp_path / "run", *WATCHED, roles=ROLES) as robot:
        supervisor = robot.nodes["supervisor"]
        assert isinstance(supervisor, ManagedNode)
        robot.spin_until(lambda: robot.simulator.tick > 3, "a few ticks")
        supervisor.must(supervisor.trigger_deactivate)
        robot.settle()
        stands = robot.simulator.tick
        answer = call(robot, "supervisor/safe")
        assert not answer.success
        assert "not active" in answer.message
        robot.settle()
        assert robot.simulator.tick == stands
        supervisor.must(supervisor.trigger_activate)
        finish(robot)
    assert (tmp_path / "run" / "run_0.mcap").read_bytes() == (tmp_path / "truth" / "run" / "run_0.mcap").read_bytes()


def test_a_mode_that_is_none_is_refused_and_changes_no_bit(tmp_path: Path) -> None:
    """A law that the controller does not have, a reference there is not, noise: refused, counted, and nothing else."""
    run_experiment(load_experiment("liu2023/fig08", WATCHED), tmp_path / "truth" / "run", mode="headless")
    codec = SupervisionCodec()
    with running_graph(tmp_path / "run", *WATCHED, roles=ROLES) as robot:
        tick = pause(robot, True)
        for law, reference in (("pd", "follow"), ("controller", "sideways")):
            forged = Supervision((tick + 2) * 250_000_000, "SAFE", law, reference, 0)
            robot.publish(SUPERVISOR_MODE, codec.encode(forged))
        robot.settle()
        robot.spin_until(lambda: robot.nodes["controller"].refusals[SUPERVISOR_MODE.name] == 2, "two refusals")
        # As its timer does once a second: that there are two is in the log, and nothing else.
        robot.recorder._attendance.look()
        pause(robot, False)
        finish(robot)
    assert list(LogReader(tmp_path / "run").messages()) != but_for_publishers(tmp_path / "run")
    assert but_for_publishers(tmp_path / "run") == list(LogReader(tmp_path / "truth" / "run").messages())


def test_a_reset_begins_with_the_first_mode(tmp_path: Path) -> None:
    """After ~/reset the run is, to the byte, an undisturbed one, whatever was commanded before."""
    run_experiment(load_experiment("liu2023/fig08", WATCHED), tmp_path / "truth" / "run_reset1", mode="headless")
    with running_graph(tmp_path / "run", *WATCHED, roles=ROLES) as robot:
        robot.spin_until(lambda: robot.simulator.tick > 3, "a few ticks")
        pause(robot, True)
        assert call(robot, "supervisor/stop").success
        call(robot, "simulator/reset")
        pause(robot, False)
        finish(robot)
    written = (tmp_path / "run_reset1" / "run_reset1_0.mcap").read_bytes()
    assert written == (tmp_path / "truth" / "run_reset1" / "run_reset1_0.mcap").read_bytes()


def test_a_paced_run_is_supervised_and_replays(tmp_path: Path) -> None:
    """The clock waits for no node; what the supervisor knew at each tick is in the log, and every side repeats it."""
    result = run_experiment(load_experiment("liu2023/fig08", WATCHED), tmp_path / "run", mode="graph", realtime=50.0)
    assert result.end_reason == "completed"
    ticks = list(LogReader(tmp_path / "run").ticks())
    assert {tick.supervision.mode for tick in ticks if tick.supervision} == {"NOMINAL"}
    assert replay(tmp_path / "run", ReplayOptions()).equal


def test_a_supervisor_without_supervision_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    """Exit code 2 and one line with the key."""
    assert main(["supervisor", "--experiment", "liu2023/fig08", "--patience", "1"]) == 2
    assert "supervision: this run has none" in capsys.readouterr().err


def test_a_run_without_supervision_has_no_topic_of_it(tmp_path: Path) -> None:
    """No mode, no events, no housekeeping."""
    with running_graph(tmp_path / "run", "duration=2.0") as robot:
        finish(robot)
        names = {name for name, _ in robot.stranger.get_topic_names_and_types()}
    assert "/controller/events" in names
    assert names.isdisjoint({"/supervisor/mode", "/events", "/housekeeping"})
