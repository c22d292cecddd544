"""The page of expectations names every key and signal there is."""

from __future__ import annotations

from space_robot_bringup.experiment.expectations import Occurrence, OverTime
from space_robot_bringup.judge.signals import signals_of
from space_robot_description.load import load_robot
from tests.support.paths import ROOT

PAGE = (ROOT / "docs" / "expect.md").read_text(encoding="utf-8")


def test_every_key_and_signal_is_on_the_page() -> None:
    """Keys of conditions, and signals that are no single numbers."""
    keys = [info.alias or name for model in (OverTime, Occurrence) for name, info in model.model_fields.items()]
    groups = ("position.", "rate.", "joint.")
    signals = [name for name in signals_of(load_robot("mini")) if not name.startswith(groups)]
    assert [name for name in (*keys, *signals) if f"`{name}`" not in PAGE] == []
