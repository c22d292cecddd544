"""Run, then replay against controller and plant: every bit, for every shipped law, robot and plant, in every mode."""

from __future__ import annotations

from pathlib import Path

import pytest

from space_robot_bringup.modes.run import Mode
from space_robot_control.laws.registry import BUILT_IN
from space_robot_description.share import shipped
from space_robot_msgs_py.log.reader import LogReader
from tests.support.replays import assert_equal, record_run, replayed

TASKS = {"mini": "compare/mini", "servicer": "compare/servicer"}
# Everything that could be forgotten between a run and its replay.
ROUGH = (
    "duration=4.0",
    "seed=7",
    "plant.delay_periods=1",
    "plant.hold=zero",
    "plant.sensors.angular_velocity={noise: 1.0e-4, bias: 1.0e-4}",
    "plant.sensors.joint_position={noise: 1.0e-5, quantisation: 1.0e-6, delay: 0.25}",
    "plant.dispersion={eta: 0.2}",
    "nominal.dispersion={eta: 0.2}",
)
# Short runs of every kind of plant: a capture in mid-run, cameras that lie, a grasp that slips, an orbit.
PLANTS = {
    "liu2023/capture": ("duration=4.0", "plant.capture.time=2.0"),
    "liu2023/noise": ("duration=4.0",),
    "song2023/distorted": ("duration=1.0",),
    "song2023/position_874_pd": ("duration=1.0",),
    "song2023/pccs": ("duration=1.0", "plant.change.start=0.2", "plant.change.duration=0.5"),
    "song2023/orbit_change": ("duration=1.0",),
}


@pytest.mark.parametrize("robot", sorted(TASKS))
@pytest.mark.parametrize("law", sorted(BUILT_IN))
def test_a_run_of_every_law_on_two_robots_replays_to_the_bit(tmp_path: Path, law: str, robot: str) -> None:
    """A run of any shipped law replays to the bit, telemetry included."""
    assert_equal(record_run(tmp_path / "run", TASKS[robot], "duration=3.0", f"controller.law={law}"))


@pytest.mark.parametrize("robot", shipped("robots"))
def test_a_run_of_every_robot_replays_to_the_bit(tmp_path: Path, robot: str) -> None:
    """A run of any shipped robot replays to the bit."""
    plain = ("reference={kind: hold}", "settling_bands={}", "plant={}", "nominal={}", "control_period=0.1")
    assert_equal(
        record_run(tmp_path / "run", TASKS["mini"], f"robot={robot}", "duration=1.0", "controller={law: pd}", *plain)
    )


@pytest.mark.parametrize("experiment", PLANTS)
def test_a_run_of_every_plant_kind_replays_to_the_bit(tmp_path: Path, experiment: str) -> None:
    """A capture during the run, distorted cameras, a grasp and an orbit are in the log like everything else."""
    assert_equal(record_run(tmp_path / "run", experiment, *PLANTS[experiment]))


@pytest.mark.parametrize("law", ["adaptive", "ntsmc", "mfac"])
def test_a_run_with_noise_delay_hold_and_dispersion_replays_to_the_bit(tmp_path: Path, law: str) -> None:
    """With noise, a delay of one period, a hold of zero and both models strayed a replay still gives every bit."""
    assert_equal(record_run(tmp_path / "run", TASKS["mini"], f"controller.law={law}", *ROUGH))


@pytest.mark.ros
@pytest.mark.xdist_group("graph")
@pytest.mark.parametrize("mode", ["graph", "processes"])
def test_the_logs_of_the_graph(tmp_path: Path, mode: Mode) -> None:
    """What nodes have recorded replays like what the loop has."""
    pytest.importorskip("rclpy")
    bag = record_run(tmp_path / "run", TASKS["mini"], "controller.law=ntsmc", *ROUGH, mode=mode)
    assert sum(1 for _ in LogReader(bag).ticks()) == 17
    assert_equal(bag)


@pytest.mark.ros
@pytest.mark.xdist_group("graph")
@pytest.mark.parametrize(("law", "realtime"), [("mfac", 40.0), ("computed_torque", 20.0)])
def test_a_paced_log_with_a_break(tmp_path: Path, law: str, realtime: float) -> None:
    """Commands that were missed or late, and a controller that was away for a while: what acted then acts again."""
    pytest.importorskip("rclpy")
    from space_robot_msgs_py.nodes.managed import ManagedNode
    from tests.support.harness import running_graph

    with running_graph(
        tmp_path / "run", "duration=30.0", f"controller.law={law}", experiment=TASKS["mini"], realtime=realtime
    ) as robot:
        controller = robot.nodes["controller"]
        assert isinstance(controller, ManagedNode)
        controller.must(controller.trigger_deactivate)
        robot.spin_until(lambda: robot.simulator.tick > 20, "some periods without commands")
        controller.must(controller.trigger_activate)
        robot.spin_until(lambda: robot.simulator.end_reason, "the end of the run")
        robot.settle()
        robot.recorder.finish("completed")
    done = replayed(tmp_path / "run")
    assert [outcome.first for outcome in done.outcomes] == [None, None]
    assert "have no recorded answer" in done.outcomes[0].remarks[0]
    assert done.outcomes[1].ticks == 121
