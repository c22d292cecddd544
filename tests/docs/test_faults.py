"""The page of the faults: tables made from their classes, and examples that are accepted."""

from __future__ import annotations

import re

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_description.validation import parse_yaml_text
from space_robot_sim.faults.catalogue import KINDS, groups, parse_fault
from space_robot_sim.faults.docs import filled
from tests.support.paths import ROOT

PAGE = (ROOT / "docs" / "faults.md").read_text(encoding="utf-8")


def test_the_tables_are_up_to_date() -> None:
    """Kinds and keys on the page are those of the classes: python -m space_robot_sim.faults.docs docs/faults.md."""
    assert filled(PAGE) == PAGE


def test_every_group_has_a_table() -> None:
    """And every kind a row."""
    assert [name for name in groups() if f"<!-- faults of {name}" not in PAGE] == []
    assert [kind for kind in KINDS if f"| `{kind}` |" not in PAGE] == []


def test_the_examples_are_faults() -> None:
    """What the page shows composes, as a file and as typed."""
    (section,) = re.findall(r"```yaml\n(faults:.*?)```", PAGE, re.DOTALL)
    experiment = load_experiment("liu2023/fig08", parse_yaml_text(section, "docs/faults.md"))
    plan = compose(experiment).faults
    assert plan is not None
    assert len(plan.planned) == 4
    typed = re.findall(r"--fault '([^']+)'", PAGE)
    assert len(typed) == 3, typed
    assert all(parse_fault(text)["kind"] in KINDS for text in typed)
