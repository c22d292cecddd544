"""The experiment that a call of the Python API was given."""

from __future__ import annotations

from space_robot_bringup.experiment.experiment import Experiment, Overrides, load_experiment, with_changes
from space_robot_msgs_py.paths import StrPath


def given_experiment(experiment: StrPath | Experiment, overrides: Overrides | None) -> Experiment:
    """A loaded experiment, or one to be loaded, with overrides.

    Args:
        experiment: a shipped name, the path of a YAML file, or a loaded experiment.
        overrides: as a mapping or as texts; None: nothing is changed.

    Raises:
        SpaceRobotError: the experiment or an override cannot be used.
    """
    if isinstance(experiment, Experiment):
        return with_changes(experiment, overrides or ())
    return load_experiment(experiment, overrides or ())
