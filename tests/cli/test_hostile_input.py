"""What cannot be run is refused in one line that names key and value, before anything is written."""

from __future__ import annotations

from io import StringIO
from pathlib import Path

import pytest
from rich.console import Console

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.run import run_experiment
from space_robot_cli.render import run as render
from space_robot_description.share import resource
from space_robot_msgs_py.errors import LogError, SpaceRobotError, SpecError

EXPERIMENT = """
title: "[red] [/] brackets"
robot: mini
control_period: 0.25
duration: 0.5
initial: {joints_deg: [90, 45, 45, 0]}
reference: {kind: step, attitude_deg: [10, 0, 0]}
"""
REFUSED = {
    "a truth value": ("plant.sensors.attitude.noise=true", "plant.sensors.attitude.noise", "a number"),
    "a text": ("control_period='0.25'", "control_period", "a number"),
    "a huge number": ("plant.sensors.position.bias=1e308", "plant.sensors.position.bias", "1e+15"),
    "a huge time": ("reference.time=1e300", "reference.time", "1e+15"),
    "a run of ages": ("duration=1e10", "duration", "at most 9007199 s"),
    "a period beyond the run": ("control_period=8.0", "duration", "e.g. 8 or 16"),
    "a step without end": ("plant.integrator.step=1e-9", "plant.integrator.step", "at least 1.25e-05 s"),
    "a step of nothing": ("plant.integrator.step=1e-300", "plant.integrator.step", "at least 1.25e-05 s"),
    "too few components": ("plant.sensors.attitude.noise=[1, 2]", "plant.sensors.attitude.noise", "or 3"),
    "a delay off the grid": ("plant.sensors.attitude.delay=0.1", "plant.sensors.attitude.delay", "multiples of 0.25"),
    "a delay of ages": ("plant.sensors.attitude.delay=1e9", "plant.sensors.attitude.delay", "at most 10000"),
    "joints twice": ("initial.joints=[0, 1, 0, 0]", "initial", "not both"),
    "a start outside the limits": ("initial.joints_deg=[90, 45, 45, 1000]", "initial.joints_deg.joint4", "-180 to 180"),
    "an empty bound": ("expect={base/roll.final_error: {}}", "expect.base/roll.final_error", "value, min or max"),
    "bounds that exclude each other": (
        "expect={base/roll.final_error: {min: 2, max: 1}}",
        "expect.base/roll.final_error",
        "not be above",
    ),
    "half a mapping": ("controller.gains={", "--set controller.gains", "YAML"),
    "an unknown alias": ("title=*a", "--set title", "YAML"),
    "too many digits": ("seed=" + "9" * 5000, "--set seed", "128 bits"),
}


@pytest.fixture
def experiment_file(tmp_path: Path) -> Path:
    """An experiment that runs."""
    path = tmp_path / "mine.yaml"
    path.write_text(EXPERIMENT, encoding="utf-8")
    return path


@pytest.mark.parametrize(("override", "key", "accepted"), list(REFUSED.values()), ids=list(REFUSED))
def test_an_impossible_override_is_refused_by_check(
    experiment_file: Path, override: str, key: str, accepted: str
) -> None:
    """`check` names the key and what is accepted in one short line."""
    with pytest.raises(SpaceRobotError) as refusal:
        compose(load_experiment(str(experiment_file), [override]))
    line = str(refusal.value)
    assert key in line
    assert accepted in line
    assert "\n" not in line
    assert len(line) < 400


@pytest.mark.parametrize(
    "override",
    ["initial.angular_velocity=[1e15, 0, 0]", "plant.sensors.attitude.noise=1e15", "plant.sensors.position.noise=1e15"],
)
def test_what_only_a_run_can_show_ends_with_a_verdict_or_leaves_nothing(experiment_file: Path, override: str) -> None:
    """Numbers that pass every check still never leave half a log: there is none, or one with a reason and a verdict."""
    bag = experiment_file.with_name("bag")
    try:
        result = run_experiment(load_experiment(str(experiment_file), [override]), bag, mode="headless")
    except SpaceRobotError:
        assert not bag.exists()
    else:
        assert result.checks
        assert result.end_reason


def test_a_recording_with_gaps_is_refused(experiment_file: Path) -> None:
    """A recorded reference of another control period is refused before the run, not in its middle."""
    row, still = [0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1], [0] * 10
    columns = {"q": [row, row], "v": [still, still], "a": [still, still]}
    recorded = {"kind": "recorded", "stamps": [0, 250_000_001], **columns}
    with pytest.raises(SpecError, match=r"reference.stamps: none at 250000000 ns; got \[0, 250000001\]"):
        compose(load_experiment(str(experiment_file), [f"reference={recorded}"]))


def test_a_picture_is_written_to_the_given_path(experiment_file: Path) -> None:
    """A folder is no picture, and a name without a suffix stays as it is."""
    pytest.importorskip("matplotlib")
    from space_robot_report.figures.log import draw

    bag = experiment_file.with_name("bag")
    run_experiment(load_experiment(str(experiment_file)), bag, mode="headless")
    before = set(experiment_file.parent.iterdir())
    with pytest.raises(LogError, match="cannot be written"):
        draw(bag, experiment_file.parent)
    assert set(experiment_file.parent.iterdir()) == before
    draw(bag, experiment_file.parent / "picture")
    assert (experiment_file.parent / "picture").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("name", ["x" * 5000, "a\0b"])
def test_names_no_system_can_look_up_are_no_files(experiment_file: Path, name: str) -> None:
    """Experiments, robots and URDFs that cannot exist are missing files, not failures of the system."""
    for ask in (
        lambda: load_experiment(name),
        lambda: compose(load_experiment(str(experiment_file), [f"robot={name}"])),
        lambda: resource(name, experiment_file.parent),
    ):
        with pytest.raises(SpaceRobotError):
            ask()


def test_run_directories_are_where_the_words_lead(experiment_file: Path) -> None:
    """``a/../b`` is ``b`` even where there is no ``a``; a loop of links is refused."""
    experiment = load_experiment(str(experiment_file))
    result = run_experiment(experiment, experiment_file.parent / "a" / ".." / "b", mode="headless")
    assert result.end_reason == "completed"
    assert (experiment_file.parent / "b").is_dir()
    (experiment_file.parent / "loop").symlink_to("loop")
    with pytest.raises(LogError, match="loop"):
        run_experiment(experiment, experiment_file.parent / "loop", mode="headless")


def test_names_with_brackets_are_shown_as_they_are(experiment_file: Path) -> None:
    """A title is text, never markup."""
    experiment, out = load_experiment(str(experiment_file)), StringIO()
    result = run_experiment(experiment, experiment_file.with_name("bag"), mode="headless")
    render.verdict(Console(file=out), experiment, "headless", result, 1.0)
    assert "[red] [/] brackets" in out.getvalue()
