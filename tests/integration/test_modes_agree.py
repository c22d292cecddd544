"""One experiment, three compositions, the same bits: the claim everything else stands on."""

from __future__ import annotations

import json
import traceback
from pathlib import Path
from typing import Any

import pytest

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.hooks import Hooks
from space_robot_bringup.modes.run import Mode, run_experiment
from space_robot_bringup.replay.replay import ReplayOptions, replay
from space_robot_description.load import load_robot
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.topics import WHEEL_MOMENTUM
from tests.support.busy import burning_core

pytest.importorskip("rclpy")
from space_robot_bringup.modes.processes import run_processes

pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]


def rubbing() -> dict[str, Any]:
    """The robot mini with friction in its joints."""
    robot = dict(load_robot("mini").resolved)
    joints = {**robot["actuators"]["joints"], "viscous": 0.1, "coulomb": 0.02}
    return robot | {"actuators": {**robot["actuators"], "joints": joints}}


# Noise, delay, a topic that few runs have, and friction that the law knows: everything that could tell the modes apart.
ROUGH = (
    f"robot={json.dumps(rubbing())}",
    "nominal.friction=true",
    "plant.delay_periods=1",
    "plant.sensors.angular_velocity={noise: 1.0e-5}",
    "plant.sensors.joint_position={noise: 1.0e-5, quantisation: 1.0e-6}",
    "plant.sensors.wheel_momentum={noise: 1.0e-5, bias: 1.0e-3, delay: 0.25}",
    "duration=10.0",
)


def run_mode(directory: Path, mode: Mode, overrides: tuple[str, ...] = ()) -> Path:
    result = run_experiment(load_experiment("liu2023/fig08", overrides), directory, mode=mode)
    assert result.end_reason == "completed"
    return directory


def bag(directory: Path) -> bytes:
    (log,) = directory.glob("*.mcap")
    return log.read_bytes()


def messages(directory: Path) -> list[tuple[str, int, bytes]]:
    return list(LogReader(directory).messages())


@pytest.fixture(scope="module")
def truth(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The rough run without ROS."""
    return run_mode(tmp_path_factory.mktemp("truth") / "run", "headless", ROUGH)


@pytest.mark.parametrize("mode", ["graph", "processes"])
def test_the_three_modes_log_the_same_messages(truth: Path, tmp_path: Path, mode: Mode) -> None:
    """Headless, graph and processes give equal messages, and equal files; a second time: on a busy machine below."""
    other = run_mode(tmp_path / "run", mode, ROUGH)
    assert len(messages(truth)) > 400
    assert messages(other) == messages(truth), f"{mode} differs from headless"
    assert bag(other) == bag(truth), f"the file of {mode} differs from that of headless"


def test_a_run_whose_wheels_are_measured_replays_equal(truth: Path) -> None:
    """Law and plant repeat it from the log, and every reading is compared; without the topic a tick is not complete."""
    replayed = replay(truth, ReplayOptions())
    assert replayed.equal, [str(outcome.first) for outcome in replayed.outcomes]
    plant = next(outcome for outcome in replayed.outcomes if outcome.against == "plant")
    assert plant.comparison.compared[WHEEL_MOMENTUM.name] == len(list(LogReader(truth).ticks())) == 41
    assert plant.absent == ()


@pytest.mark.parametrize("mode", ["graph", pytest.param("processes", marks=pytest.mark.thorough)])
def test_a_shipped_experiment_logs_the_same_to_its_end(tmp_path: Path, mode: Mode) -> None:
    """As it is shipped, with bounds that hold."""
    for name, how in (("headless", "headless"), ("other", mode)):
        assert run_experiment(load_experiment("liu2023/fig08"), tmp_path / name / "run", mode=how).passed  # type: ignore[arg-type]
    assert bag(tmp_path / "other" / "run") == bag(tmp_path / "headless" / "run")


def test_laws_that_take_turns_log_the_same_in_every_mode(tmp_path: Path) -> None:
    """Switches of the schedule, with their events at the tick they act on, are in equal files."""
    experiment = load_experiment("switch/mini", ["duration=60.0"])
    for mode in ("headless", "graph", "processes"):
        run_experiment(experiment, tmp_path / mode / "run", mode=mode)  # type: ignore[arg-type]
    truth = bag(tmp_path / "headless" / "run")
    stamps = [stamp for topic, stamp, _ in messages(tmp_path / "headless" / "run") if topic == "controller/events"]
    assert stamps == [25_000_000_000, 50_000_000_000]
    for mode in ("graph", "processes"):
        assert bag(tmp_path / mode / "run") == truth, f"the file of {mode} differs from that of headless"


def test_a_busy_machine_changes_no_bit(truth: Path, tmp_path: Path) -> None:
    """Timing is not an input: with a core burnt by another process the log is the same."""
    with burning_core():
        assert bag(run_mode(tmp_path / "run", "graph", ROUGH)) == bag(truth)


def test_a_busy_machine_and_a_late_controller_change_no_bit(truth: Path, tmp_path: Path) -> None:
    """The run waits for its controller: started 1.5 s after the others, with a core burnt, it gives the same run."""
    composition, late = compose(load_experiment("liu2023/fig08", ROUGH)), tmp_path / "run"
    with burning_core():
        reason = run_processes(composition, late, realtime=None, hooks=Hooks(), late={"controller": 1.5})
    assert reason == "completed"
    assert bag(late) == bag(truth)


FAILING_LAW = """
from space_robot_control.laws.base import Law
from space_robot_msgs_py.errors import ControlError

class Failing(Law):
    def compute(self, state, reference):
        if state.stamp == 3_000_000_000:
            raise ControlError("covariance lost", key="rls", value=-1.0)
        return [0.0] * (6 + self.robot.n), {}
"""


def test_a_law_that_fails_ends_every_mode_alike(tmp_path: Path) -> None:
    """The run ends with the law's error in the log, and with the state that broke it as the last message."""
    law = tmp_path / "failing.py"
    law.write_text(FAILING_LAW)
    experiment = load_experiment("liu2023/fig08", [f"controller={{law: '{law}:Failing'}}"])
    bags = []
    for mode in ("headless", "graph", "processes"):
        directory = tmp_path / mode / "run"
        result = run_experiment(experiment, directory, mode=mode)  # type: ignore[arg-type]
        assert result.end_reason == LogReader(directory).end_reason
        assert "controller: " in result.end_reason
        assert "covariance lost" in result.end_reason
        assert not result.passed
        assert max(stamp for _, stamp, _ in messages(directory)) == 3_000_000_000
        bags.append(bag(directory))
    assert bags[1] == bags[0]
    assert bags[2] == bags[0]


BROKEN_LAW = """
from space_robot_control.laws.base import Law

class Broken(Law):
    def compute(self, state, reference):
        raise KeyError("a bug")
"""


def test_a_bug_in_a_law_ends_every_mode_alike(tmp_path: Path) -> None:
    """What a law should never raise ends the run with law, tick and cause, and comes with its traceback."""
    law = tmp_path / "broken.py"
    law.write_text(BROKEN_LAW)
    experiment = load_experiment("liu2023/fig08", [f"controller={{law: '{law}:Broken'}}"])
    bags = []
    for mode in ("headless", "graph"):
        failures: list[BaseException] = []
        hooks, place = Hooks(on_failure=failures.append), tmp_path / mode / "run"
        result = run_experiment(experiment, place, mode=mode, hooks=hooks)  # type: ignore[arg-type]
        assert result.end_reason == LogReader(place).end_reason == "controller: law Broken at tick 0: KeyError: 'a bug'"
        assert not result.passed
        (cause,) = [failure.__cause__ for failure in failures]
        assert isinstance(cause, KeyError)
        assert traceback.extract_tb(cause.__traceback__)[-1].filename == str(law)
        bags.append(bag(place))
    assert bags[1] == bags[0]
