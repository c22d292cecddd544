"""What launch files check before they start anything; ROS launch may run under a Python without our dependencies."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from difflib import get_close_matches
from pathlib import Path

from space_robot_msgs_py.errors import SpecError


def refuse_unknown_arguments(file: str, accepted: Collection[str], given: Sequence[str], typed: Sequence[str]) -> None:
    """Refuse ``name:=value`` with a name that the launch file does not have.

    Args:
        file: name of the launch file.
        accepted: names of its arguments.
        given: what ``ros2 launch`` was given for it, ``name:=value`` each.
        typed: command line of ``ros2 launch``. Where another launch file includes this one, names may be that one's.

    Raises:
        SpecError: names the first such argument and the nearest that there are.
    """
    if not any(Path(word).name == file for word in typed):
        return
    for argument in given:
        name = argument.partition(":=")[0]
        if name not in accepted:
            near = get_close_matches(name, accepted, n=1)
            hint = f"did you mean {near[0]}? valid: {', '.join(accepted)}" if near else ", ".join(accepted)
            raise SpecError("no such launch argument", key=name, value=argument, accepted=hint)


def check_experiment(experiment: str, overrides: Sequence[str]) -> None:
    """Refuse an experiment that every node would refuse; where that cannot be checked here, the nodes do it.

    Args:
        experiment: shipped name or file.
        overrides: ``key=value`` each.

    Raises:
        SpaceRobotError: what is wrong with it.
    """
    try:
        from space_robot_bringup.experiment.experiment import load_experiment
    except ImportError:
        return
    load_experiment(experiment, list(overrides))
