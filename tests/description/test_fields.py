"""Typed models as parameters: what people and ROS see of a file, and how a part of it changes."""

from __future__ import annotations

import pytest
from pydantic import Field, NonNegativeFloat, PositiveFloat

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.compose.parameters import rows_of
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.hooks import ROLES
from space_robot_bringup.nodes.arguments import Start
from space_robot_control.laws.registry import BUILT_IN, law_class
from space_robot_description.fields import DYNAMIC, changed, parameter_rows
from space_robot_description.spec import Strict
from space_robot_msgs_py.errors import SpecError


class Inner(Strict):
    """A section."""

    kind: str = "inner"
    rate: NonNegativeFloat | tuple[NonNegativeFloat, ...] | None = Field(default=1.0, description="[1/s]")
    share: float = Field(default=0.5, ge=0.0, lt=1.0, description="[-]")


class Outer(Strict):
    """A file."""

    soft: Inner = Field(default_factory=Inner, json_schema_extra=DYNAMIC)
    hard: Inner = Field(default_factory=Inner)
    size: PositiveFloat = Field(default=2.0, alias="length", description="[m]", json_schema_extra=DYNAMIC)
    names: tuple[str, ...] = ("a", "b")


def test_rows_have_dotted_names_plain_values_and_bounds() -> None:
    """Sections become prefixes, aliases names; a union has its number's bounds; a dynamic section is so throughout."""
    rows = {row.name: row for row in parameter_rows(Outer(), "x.")}
    assert list(rows) == [
        *("x.soft.kind", "x.soft.rate", "x.soft.share"),
        *("x.hard.kind", "x.hard.rate", "x.hard.share"),
        *("x.length", "x.names"),
    ]
    assert (rows["x.soft.rate"].lower, rows["x.soft.rate"].upper) == (0.0, None)
    assert (rows["x.hard.share"].lower, rows["x.hard.share"].upper) == (0.0, 1.0)
    assert rows["x.names"].value == ["a", "b"]
    assert [name for name, row in rows.items() if row.dynamic] == [
        *("x.soft.kind", "x.soft.rate", "x.soft.share"),
        "x.length",
    ]
    assert rows["x.soft.kind"].description == "A section."


def test_a_change_is_a_new_model_and_checked_as_a_whole() -> None:
    """The old model stays; names, sections and values that do not fit are refused with their key."""
    old = Outer()
    new = changed(old, {"soft.rate": [1.0, 2.0], "length": 3}, "gains.")
    assert (new.soft.rate, new.size) == ((1.0, 2.0), 3.0)
    assert old == Outer()
    for changes, why in (
        ({"soft.rat": 1.0}, "gains.soft.rat: .*accepted: soft.rate"),
        ({"hard.rate": 1.0}, "gains.hard.rate: cannot change during the run"),
        ({"soft": {"rate": 1.0}}, "gains.soft: there is no such number"),
        ({"soft.share": 1.0}, "gains.soft.share: .*less than 1"),
    ):
        with pytest.raises(SpecError, match=why):
            changed(old, changes, "gains.")


@pytest.mark.parametrize("experiment", ["liu2023/fig08", "switch/mini", "song2023/pccs", "giordano2023/sec5"])
def test_every_parameter_of_every_node_explains_itself(experiment: str) -> None:
    """No parameter without a description, whatever plant, reference or law the experiment has."""
    composition = compose(load_experiment(experiment))
    rows = [row for role in ROLES for row in rows_of(role, composition)]
    rows += [*composition.controller().parameters(), *parameter_rows(Start())]
    rows += [row for name in BUILT_IN for row in parameter_rows(law_class(name).Gains())]
    assert [row.name for row in rows if not row.description] == []
