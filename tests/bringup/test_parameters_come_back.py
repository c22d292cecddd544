"""What a node shows as parameters starts it again: as ``ros2 param dump`` writes it and ``--params-file`` reads it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("rclpy")
import yaml

from space_robot_bringup.compose.composition import Composition
from space_robot_bringup.compose.parameters import rows_of
from space_robot_bringup.experiment.dotted_keys import set_key
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.context import local_context, reserved_domain
from space_robot_bringup.nodes.arguments import composed, start_from
from space_robot_description.fields import parameter_rows
from space_robot_msgs_py.errors import SpaceRobotError
from space_robot_msgs_py.nodes.parameters import from_ros, given_at_start, to_ros
from tests.support.paths import ROOT

pytestmark = pytest.mark.ros
FOLDER = ROOT / "config" / "experiments"
SHIPPED = sorted(path.relative_to(FOLDER).with_suffix("").as_posix() for path in FOLDER.rglob("*.yaml"))
ROLES = ("recorder", "guidance", "controller", "simulator", "supervisor")


def shown_by(role: str, name: str, composition: Composition, sets: tuple[str, ...] = ()) -> dict[str, Any]:
    """What a node shows, as ROS has it."""
    rows = [*parameter_rows(start_from({"experiment": name, "set": list(sets)}, {})), *rows_of(role, composition)]
    rows += composition.controller().parameters() if role == "controller" else []
    return {row.name: to_ros(row.value) for row in rows}


def content(composition: Composition) -> dict[str, Any]:
    """The experiment with the gains that its law really has, whatever the file says of them."""
    data = composition.experiment.model_dump(mode="json")
    data["controller"] |= {"gains": "", "standby": sorted(data["controller"]["standby"])}
    for mode in (data.get("supervision") or {"modes": {}})["modes"].values():
        mode.pop("gains", None)
    return data | {"law": [(row.name, row.value) for row in composition.controller().parameters()]}


@pytest.mark.parametrize(
    ("name", "sets"),
    [
        *((name, ()) for name in SHIPPED),
        ("liu2023/fig08", ("supervision=mini_basic",)),
        ("liu2023/fig08", ("controller.gains.lambda.joints=0.7", "reference={kind: live}")),
    ],
)
def test_what_a_node_shows_starts_it_again(name: str, sets: tuple[str, ...]) -> None:
    """Every role of every shipped experiment, with what was overridden: the same experiment, and the same gains."""
    first = composed(start_from({"experiment": name, "set": list(sets)}, {}), {})
    for role in ROLES:
        given = {key: from_ros(value) for key, value in shown_by(role, name, first, sets).items()}
        if role == "controller":
            assert content(composed(start_from({"set": []}, given), given)) == content(first)
        else:
            start = start_from({"set": []}, given)
            assert load_experiment(start.experiment, start.set) == first.experiment, role


def test_a_dumped_file_is_read_by_ros(tmp_path: Path) -> None:
    """Through the file and the parser of ROS: nested as ``ros2 param dump`` writes it, the values are the same."""
    composition = composed(start_from({"experiment": "switch/mini", "set": []}, {}), {})
    shown = shown_by("controller", "switch/mini", composition)
    nested: dict[str, Any] = {}
    for key, value in shown.items():
        set_key(nested, key, value, key)
    file = tmp_path / "controller.yaml"
    file.write_text(yaml.safe_dump({"/controller": {"ros__parameters": nested}}))
    with reserved_domain() as domain, local_context(domain, ["--ros-args", "--params-file", str(file)]) as context:
        assert given_at_start("controller", context) == {key: from_ros(value) for key, value in shown.items()}


def test_one_of_the_gains_that_a_number_stands_for_may_be_given() -> None:
    """The others keep the number of the experiment."""
    given = {"experiment": "liu2023/fig08", "gains.lambda.joints": 0.7}
    found = dict(content(composed(start_from({"set": []}, given), given))["law"])
    assert [found[f"gains.lambda.{part}"] for part in ("translation", "rotation", "joints")] == [1.0, 1.0, 0.7]


@pytest.mark.parametrize(
    ("given", "why"),
    [
        ({"gains.kapa": 1.0}, "parameter gains.kapa: unknown key"),
        ({"gains.lambda.joint": 1.0}, "parameter gains.lambda.joint: leads to"),
        ({"gains.lambda.joints": -1.0}, "parameter gains.lambda.joints"),
        ({"gains.kappa": "{a"}, "parameter gains.kappa"),
        ({"plant.delay_periods": 7.5}, "parameter plant.delay_periods"),
        ({"duration": "long"}, "parameter duration"),
        ({"law": "nothing"}, "parameter law"),
        ({"colour": "red"}, "parameter colour"),
        ({"set": ["plant.delay=1"]}, "parameter set"),
    ],
)
def test_an_error_names_the_parameter(given: dict[str, Any], why: str) -> None:
    """As the user typed it, and not as the experiment or the command line has it."""
    with pytest.raises(SpaceRobotError) as error:
        composed(start_from({"experiment": "liu2023/fig08", "set": []}, given), given)
    assert why in str(error.value)
    assert "--set" not in str(error.value)
