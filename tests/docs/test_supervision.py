"""The page of the supervisor names every key and value there is, and its tables are accepted."""

from __future__ import annotations

import re

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_description.load import load_robot
from space_robot_description.share import shipped
from space_robot_description.validation import parse_yaml_text
from space_robot_supervisor.rows import ModeSpec, MonitorSpec
from space_robot_supervisor.values import values_of
from tests.support.paths import ROOT

PAGE = (ROOT / "docs" / "supervision.md").read_text(encoding="utf-8")


def test_every_key_and_value_is_on_the_page() -> None:
    """Keys of modes and monitors, values that are no single numbers, and the shipped tables."""
    keys = [info.alias or name for model in (ModeSpec, MonitorSpec) for name, info in model.model_fields.items()]
    robot = load_robot("mini")
    groups = ("position.", "attitude.", "rate.", "joint.")
    values = [name for name in values_of(robot) if not name.startswith(groups)]
    assert [name for name in (*keys, *values, *shipped("supervision")) if f"`{name}`" not in PAGE] == []


def test_the_tables_on_the_page_compose() -> None:
    """As sections of an experiment."""
    sections = re.findall(r"```yaml\n(supervision:.*?)```", PAGE, re.DOTALL)
    assert len(sections) == 4
    for section in sections:
        case = "point_to_point/panda_sat" if "panda_sat" in section else "liu2023/fig08"
        experiment = load_experiment(case, {"duration": 100.0} | dict(parse_yaml_text(section, "docs/supervision.md")))
        assert experiment.supervision is not None
        compose(experiment)
