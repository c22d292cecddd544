"""The table of faults says of each run what became of the robot; promises made of it are kept on a slice."""

from __future__ import annotations

from typing import Any

import pytest

from benchmarks.coverage import cell, chosen, outcome, summary, table
from space_robot_sim.faults.catalogue import KINDS
from space_robot_studies.campaign.cases import make_case
from space_robot_studies.campaign.run_case import run_case


@pytest.mark.parametrize(
    ("failed", "completed", "found"),
    [
        ("", True, "survives"),
        ("error.attitude", True, "degrades"),
        ("error.attitude, error.joints", True, "degrades"),
        ("error.joints, error.joints", True, "safe"),
        ("error.attitude, error.attitude, base.rate", True, "lost"),
        ("joints.beyond", True, "lost"),
        ("", False, "lost"),
    ],
)
def test_an_outcome_is_read_from_a_row(failed: str, completed: bool, found: str) -> None:
    """By what it missed, and whether it moved at the end."""
    assert outcome({"failed": failed, "completed": completed}) == found


def test_a_cell_has_the_worst_of_its_draws() -> None:
    """And how many of them were so, where not all were."""
    fine, lost = {"failed": "", "completed": True}, {"failed": "base.rate", "completed": True}
    assert (cell([fine, fine]), cell([fine, lost, fine])) == ("survives", "lost 1/3")


def test_what_is_lost_is_said_with_its_reason() -> None:
    """Counts of all outcomes, and a line per cell that supervision does not save."""
    both = {"completed": True, "controller": "pd", "faults": "joint_free"}
    rows = [both | {"failed": "joints.beyond, base.rate", "supervision": how} for how in ("without", "with")]
    said = summary([*rows, both | {"failed": "", "supervision": "with"}])
    assert "Of 1 runs each, without → with supervision: 0 → 1 survives, 0 → 0 degrades, 0 → 0 safe, 1 → 1 lost." in said
    assert "- `joint_free` with `pd`: a joint beyond its limit, the base moves (1)" in said


@pytest.mark.parametrize(("robot", "none"), [("mini", "thruster"), ("servicer", "wheel")])
def test_every_kind_that_the_robot_can_have_is_in_the_campaign(robot: str, none: str) -> None:
    """All but those of thrusters or wheels, each under its own name, with a key of its own for the draws."""
    faults: Any = chosen(1, (), robot).vary["faults"]
    assert set(faults) == {kind for kind in KINDS if not kind.startswith(none)}
    assert all(kind == fault["kind"] for kind, (fault,) in faults.items())


# Whatever the law, without and with supervision.
HARMLESS = ("sensor_sign_flip", "link_duplicate", "controller_restarted")


def test_promises_of_the_table_are_kept_on_a_slice() -> None:
    """What must be harmless is, with the law that is known best; the supervisor changes nothing of it."""
    campaign = chosen(1, HARMLESS)
    cases = [make_case(campaign, index) for index in range(campaign.cases)]
    rows = []
    for case in (case for case in cases if case.labels["controller"] == "computed_torque"):
        rows.append(case.columns() | run_case(case.data, "slice", "none").columns)
        assert outcome(rows[-1]) == "survives", rows[-1]
    assert table(rows).count("survives → survives") == len(HARMLESS)


# Lost without supervision, whatever the draw, and not with it.
SAVED = {"joint_runaway": "computed_torque", "joint_offset": "computed_torque", "sensor_bias": "adaptive"}


def test_supervision_saves_what_is_lost_without_it() -> None:
    """Brakes stop a joint before its end, and another law answers for one that has learned what cannot be."""
    campaign = chosen(1, tuple(SAVED))
    cases = [make_case(campaign, index) for index in range(campaign.cases)]
    judged = [case for case in cases if case.labels["controller"] == SAVED[case.labels["faults"]]]
    assert len(judged) == 2 * len(SAVED)
    for case in judged:
        row = case.columns() | run_case(case.data, "slice", "none").columns
        assert (outcome(row) == "lost") is (case.labels["supervision"] == "without"), row
