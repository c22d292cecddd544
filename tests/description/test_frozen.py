"""What was checked does not change: typed files are immutable to the last dict and list inside."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pydantic import BaseModel

from space_robot_bringup.experiment.experiment import Experiment, experiment_from, load_experiment, to_yaml
from space_robot_description.frozen import FrozenDict, FrozenList, frozen, plain
from space_robot_description.share import shipped
from space_robot_description.validation import parse_yaml_text
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.log.reader import LogReader
from space_robot_studies.campaign.spec import load_campaign
from tests.support.nonempty import nonempty

GOLDEN = sorted((Path(__file__).parents[1] / "data" / "golden").iterdir())
DATA: dict[str, Any] = {
    "robot": "mini",
    "control_period": 0.1,
    "duration": 1.0,
    "initial": {"joints_deg": {"joint1": 10}},
    "reference": {"kind": "hold"},
    "controller": {"law": "adaptive", "gains": {"rls": {"reset": {"threshold": 3.0}}, "list": [1, [2, {"deep": 3}]]}},
    "settling_bands": {"base/roll": 0.5},
}


def containers(value: Any) -> Iterator[Any]:
    """Every dict and list in a value, models included."""
    if isinstance(value, dict | list):
        yield value
    if isinstance(value, BaseModel):
        value = dict(value)
    children = value.values() if isinstance(value, dict) else value if isinstance(value, list | tuple) else ()
    for child in children:
        yield from containers(child)


@pytest.mark.parametrize("name", shipped("experiments"))
def test_nothing_in_a_loaded_experiment_can_be_changed(name: str) -> None:
    """Gains, bands, joints by name: every container of a shipped experiment is read-only, whatever it is of."""
    found = list(containers(load_experiment(name)))
    assert found
    assert all(isinstance(one, FrozenDict | FrozenList) for one in found), found


@pytest.mark.parametrize("name", shipped("campaigns"))
def test_nothing_in_a_loaded_campaign_can_be_changed(name: str) -> None:
    """Also what was resolved after the check, such as the experiment of all runs, is read-only."""
    assert all(isinstance(one, FrozenDict | FrozenList) for one in nonempty(containers(load_campaign(name, 2))))


CHANGES: list[Callable[[Experiment], object]] = [
    lambda experiment: experiment.controller.gains.update(kappa=-1.0),
    lambda experiment: experiment.controller.gains.__setitem__("kappa", -1.0),
    lambda experiment: experiment.controller.gains.__delitem__("rls"),
    lambda experiment: experiment.controller.gains.__ior__({"kappa": -1.0}),
    lambda experiment: experiment.controller.gains["rls"]["reset"].clear(),
    lambda experiment: experiment.controller.gains["rls"].pop("reset"),
    lambda experiment: experiment.controller.gains["rls"].popitem(),
    lambda experiment: experiment.controller.gains["rls"].setdefault("floor", 1.0),
    lambda experiment: experiment.controller.gains["list"].append(2),
    lambda experiment: experiment.controller.gains["list"].__setitem__(0, 2),
    lambda experiment: experiment.controller.gains["list"].__delitem__(0),
    lambda experiment: experiment.controller.gains["list"].__iadd__([2]),
    lambda experiment: experiment.controller.gains["list"].__imul__(2),
    lambda experiment: experiment.controller.gains["list"][1][1].update(deep=4),
    lambda experiment: experiment.controller.gains["list"][1].extend([2]),
    lambda experiment: experiment.controller.gains["list"].insert(0, 2),
    lambda experiment: experiment.controller.gains["list"].remove(1),
    lambda experiment: experiment.controller.gains["list"].pop(),
    lambda experiment: experiment.controller.gains["list"].clear(),
    lambda experiment: experiment.controller.gains["list"].sort(),
    lambda experiment: experiment.controller.gains["list"].reverse(),
    lambda experiment: experiment.settling_bands.update({"base/roll": 5.0}),
    lambda experiment: experiment.initial.joints_deg.update(joint1=5.0),  # type: ignore[union-attr]
]


@pytest.mark.parametrize("change", CHANGES)
def test_every_way_to_change_a_container_is_refused(change: Callable[[Experiment], object]) -> None:
    """A change raises and leaves the experiment as it was, whichever method it is tried with."""
    experiment = experiment_from(DATA, "test")
    before = to_yaml(experiment)
    with pytest.raises(TypeError, match="read-only"):
        change(experiment)
    assert to_yaml(experiment) == before


@pytest.mark.parametrize("name", ["duration", "controller", "no_such_field"])
def test_a_field_cannot_be_set_or_deleted(name: str) -> None:
    """It is an AttributeError in the words of this project, as of every immutable object."""
    experiment = experiment_from(DATA, "test")
    for change in (lambda: setattr(experiment, name, 1.0), lambda: delattr(experiment, name)):
        with pytest.raises(AttributeError, match=f"^{name}: read-only") as caught:
            change()
        assert "pydantic" not in str(caught.value)
    assert experiment == experiment_from(DATA, "test")


def test_an_experiment_copies_the_mapping_it_is_made_from() -> None:
    """Changing the mapping afterwards changes no experiment that was made from it."""
    data = copy.deepcopy(DATA)
    experiment = experiment_from(data, "test")
    data["controller"]["gains"]["list"][1][1]["deep"] = 4
    data["controller"]["gains"]["rls"]["reset"]["threshold"] = 4.0
    assert experiment == experiment_from(DATA, "test")


@pytest.mark.parametrize("duplicate", [copy.copy, copy.deepcopy, lambda it: pickle.loads(pickle.dumps(it))])
def test_copies_are_equal_and_as_immutable(duplicate: Callable[[Experiment], Experiment]) -> None:
    """Copied, deep-copied or sent to another process, an experiment stays what it is."""
    experiment = experiment_from(DATA, "test")
    again = duplicate(experiment)
    assert again == experiment
    assert to_yaml(again) == to_yaml(experiment)
    assert all(isinstance(one, FrozenDict | FrozenList) for one in nonempty(containers(again)))


def test_a_copy_with_other_values_is_as_immutable() -> None:
    """What ``model_copy`` puts in, which is not checked, is read-only like the rest."""
    other = experiment_from(DATA, "test").model_copy(update={"settling_bands": {"base/yaw": 0.1}})
    with pytest.raises(TypeError, match="read-only"):
        other.settling_bands["base/yaw"] = 1.0


@pytest.mark.parametrize("log", GOLDEN, ids=lambda path: path.name)
def test_the_resolved_text_is_that_of_the_golden_logs(log: Path) -> None:
    """An experiment out of a log resolves to the text in the log, byte for byte."""
    text = LogReader(log).header.experiment
    assert to_yaml(experiment_from(parse_yaml_text(text, "log"), "log")) == text


def test_plain_undoes_frozen() -> None:
    """A plain copy equals the frozen data, down to its types, shares nothing with it and can be changed."""
    data = plain(frozen(DATA))
    assert data == DATA
    assert not any(isinstance(one, FrozenDict | FrozenList) for one in containers(data))
    data["controller"]["gains"]["list"][1][1]["deep"] = 4
    assert data != DATA


def test_plain_data_has_no_numpy_and_no_paths() -> None:
    """Arrays, numbers of NumPy and paths become what a YAML file can say."""
    data = plain({"array": np.arange(3), "number": np.float32(0.5), "count": np.int64(2), "path": Path("a") / "b"})
    assert data == {"array": [0, 1, 2], "number": 0.5, "count": 2, "path": "a/b"}
    assert [type(value) for value in data.values()] == [list, float, int, str]


def test_python_data_that_contains_itself_is_refused() -> None:
    """A mapping made in Python may contain itself, too: as an experiment or an override it is one clear error."""
    gains: dict[str, Any] = {}
    gains["x"] = gains
    with pytest.raises(SpecError, match="contains itself"):
        experiment_from(DATA | {"controller": {"gains": gains}}, "test")
    with pytest.raises(SpecError, match=r"^controller\.gains: contains itself"):
        load_experiment("liu2023/fig08", {"controller.gains": gains})


@pytest.mark.parametrize("text", ["a: &a {b: *a}", "a: &a [*a]", "a: &a {b: [1, {c: *a}]}"])
def test_data_that_contains_itself_is_refused(text: str) -> None:
    """An alias to what it stands in would never end: one clear error, where it is read."""
    with pytest.raises(SpecError, match=r"^file: .*an alias to what it is part of"):
        parse_yaml_text(text, "file")
    assert parse_yaml_text("a: &a [1]\nb: *a", "file") == {"a": [1], "b": [1]}
