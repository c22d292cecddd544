"""Short runs and what a replay of them must say."""

from __future__ import annotations

from pathlib import Path

from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.run import Mode, run_experiment
from space_robot_bringup.replay.replay import Replayed, ReplayOptions, replay


def record_run(place: Path, experiment: str, *overrides: str, mode: Mode = "headless") -> Path:
    """Run a shipped experiment into a run directory."""
    run_experiment(load_experiment(experiment, overrides), place, mode=mode)
    return place


def replayed(bag: Path, **options: object) -> Replayed:
    """What comes out of a bag."""
    return replay(bag, ReplayOptions(**options))  # type: ignore[arg-type]


def assert_equal(bag: Path) -> None:
    """Controller and plant give every message of every tick again, bit for bit."""
    done = replayed(bag)
    for outcome in done.outcomes:
        assert outcome.first is None, (outcome.against, outcome.first)
        assert outcome.absent == ()
        assert outcome.remarks == ()
        assert len(set(outcome.comparison.compared.values())) == 1
    assert [outcome.against for outcome in done.outcomes] == ["controller", "plant"]
