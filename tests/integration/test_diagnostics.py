"""/diagnostics: what depends on the wall clock, and a second publisher of commands."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("rclpy")
from diagnostic_msgs.msg import DiagnosticStatus

from space_robot_msgs_py.topics import JOINT_COMMAND
from space_robot_sim.nodes import health
from tests.support.diagnostics import heard, numbers
from tests.support.harness import running_graph

pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]


def test_both_nodes_publish_diagnostics(tmp_path: Path) -> None:
    """Rate, counts, saturation, residuals, computation time and the condition of the estimator are there."""
    with running_graph(tmp_path / "run", "controller={law: adaptive}", "duration=400.0", realtime=5.0) as robot:
        newest = heard(robot)
        wanted = ("simulator: commands", "simulator: plant", "controller: law", "controller: estimator")
        robot.spin_until(lambda: all(name in newest for name in wanted), "all four statuses")
    commands, plant, law, estimator = (numbers(newest[name]) for name in wanted)
    assert {"ticks_per_second", "realtime_factor", "silence_s"} <= commands.keys()
    assert {"saturation_share", "momentum_residual", "energy_residual"} <= plant.keys()
    assert float(plant["momentum_residual"]) < 1e-8
    assert law["law"] == "adaptive"
    assert float(law["computation_mean_ms"]) <= float(law["computation_longest_ms"])
    assert float(estimator["covariance_condition"]) > 1.0


def test_a_second_publisher_of_commands_is_pointed_out(tmp_path: Path) -> None:
    """As long as there are two, the status of the commands is a warning that says of what, and names both nodes."""
    with running_graph(tmp_path / "run", "duration=4000.0", realtime=1.0) as robot:
        newest = heard(robot)
        robot.stranger.publisher(JOINT_COMMAND)

        def warned() -> bool:
            status = newest.get("simulator: commands")
            said = "2 publishers of joint_command (/controller, /stranger)"
            return status is not None and said in status.message

        robot.spin_until(warned, "the warning")
    assert newest["simulator: commands"].level == DiagnosticStatus.WARN


def test_a_refusal_is_a_warning_for_a_while_and_a_total_for_ever(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The status says why the newest message was refused and warns; some periods later only the numbers are left."""
    monkeypatch.setattr(health, "DIAGNOSTICS_PERIOD", 0.05)
    with running_graph(tmp_path / "run", "duration=4000.0") as robot:
        robot.simulator.pause(True)
        robot.await_answer()
        newest = heard(robot)
        robot.publish(JOINT_COMMAND, b"\x00\x01\x00\x00\x01\x02")

        def is_at(level: bytes) -> bool:
            status = newest.get("simulator: commands")
            return status is not None and status.level == level and "malformed" in numbers(status)

        robot.spin_until(lambda: is_at(DiagnosticStatus.WARN), "the warning")
        assert "1 malformed" in newest["simulator: commands"].message
        robot.stranger.destroy_publisher(robot._speakers.pop(JOINT_COMMAND))
        robot.spin_until(lambda: is_at(DiagnosticStatus.OK), "the end of the warning")
    values = numbers(newest["simulator: commands"])
    assert values["malformed"] == "1"
    assert values["newest_reason"].startswith("joint_command: malformed: ")
