"""What a launch file refuses before it starts anything."""

from __future__ import annotations

import pytest

from space_robot_bringup.launching import check_experiment, refuse_unknown_arguments
from space_robot_msgs_py.errors import SpaceRobotError

ACCEPTED = ("experiment", "realtime")
TYPED = ["ros2", "launch", "space_robot_bringup", "experiment.launch.py"]


def test_an_argument_that_there_is_not_is_refused() -> None:
    """With the nearest that there is; those that there are pass, and so does what is for a launch file around it."""
    with pytest.raises(SpaceRobotError, match=r"realtme: no such launch argument.*did you mean realtime"):
        refuse_unknown_arguments("experiment.launch.py", ACCEPTED, ["realtme:=2.0"], TYPED)
    refuse_unknown_arguments("experiment.launch.py", ACCEPTED, ["realtime:=2.0"], TYPED)
    refuse_unknown_arguments("experiment.launch.py", ACCEPTED, ["world:=mars"], ["ros2", "launch", "all.launch.py"])


@pytest.mark.parametrize(("experiment", "sets"), [("liu2023/fig80", ()), ("liu2023/fig08", ("plant.dely=1",))])
def test_an_experiment_that_cannot_be_is_refused_once(experiment: str, sets: tuple[str, ...]) -> None:
    """Before the nodes, which would all say it."""
    check_experiment("liu2023/fig08", ["duration=5.0"])
    with pytest.raises(SpaceRobotError, match=r"fig80|dely"):
        check_experiment(experiment, sets)
