"""Which runs may share a call: those of shipped laws with a compiled form, and none that need the loop."""

from __future__ import annotations

from typing import Any

import pytest

from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_control.laws.base import Law
from space_robot_control.laws.registry import BUILT_IN, law_class
from space_robot_studies.campaign.kinds import COMPILED, kind_of_case, kind_of_experiment

pytest.importorskip("numba")


def test_the_laws_are_those_that_have_a_compiled_form() -> None:
    """Every shipped law that overrides ``Law.compiled`` is in the list, and no other."""
    assert {name for name in BUILT_IN if law_class(name).compiled is not Law.compiled} == COMPILED


@pytest.mark.parametrize(
    "changes",
    [
        ["supervision=mini_basic"],
        ["controller={law: 'tests.support.laws:Buggy'}"],
        ["controller.standby={other: {law: pd, gains: {bandwidth: 0.2}}}"],
        ["duration=6000.0"],
        ["faults=[{kind: link_drop, topic: command, at: 1.0}]"],
    ],
)
def test_what_needs_the_loop_is_run_alone(changes: list[str]) -> None:
    """Supervision, faults, switching laws, laws without a compiled form and very long runs share no call."""
    assert kind_of_experiment(load_experiment("liu2023/fig08")) is not None
    assert kind_of_experiment(load_experiment("liu2023/fig08", changes)) is None


def test_an_experiment_and_its_content_are_of_one_kind() -> None:
    """What a campaign asks of plain data is what a paper asks of an experiment."""
    experiment = load_experiment("liu2023/fig08")
    data: dict[str, Any] = experiment.model_dump(mode="json")
    assert kind_of_case(data) == kind_of_experiment(experiment)
