"""Faults of the body: which robot runs when."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from space_robot_bringup.compose.composition import Composition, compose
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.headless import run_in_memory

T = 250_000_000
PAYLOAD = {"mass": 2.0, "inertia": [0.01, 0.02, 0.03], "com": [0.0, 0.0, 0.1]}


def composed(*faults: dict[str, Any], **plant: Any) -> Composition:
    """An orientation task of `mini` with these faults."""
    keys = {f"plant.{key}": value for key, value in plant.items()}
    return compose(load_experiment("liu2023/fig08", {"duration": 5.0, "faults": list(faults), **keys}))


def masses(composition: Composition) -> dict[int, float]:
    """Mass of the true robot from a tick on [kg]."""
    robots = {0: composition.truth, **{change.stamp: change.robot for change in composition.changes}}
    return {stamp // T: sum(inertia.mass for inertia in robot.model.inertias) for stamp, robot in robots.items()}


def test_a_payload_comes_and_goes() -> None:
    """Its mass is there within the window and gone after it."""
    found = masses(composed({"kind": "payload_captured", "payload": PAYLOAD, "at": 1.0, "for": 2.0}))
    empty = masses(composed())[0]
    assert found == pytest.approx({0: empty, 4: empty + 2.0, 12: empty})


def test_what_is_lost_was_held_before() -> None:
    """A payload of the start, one captured during the run and one of a fault are lost; one that comes later is not."""
    capture = {"time": 1.0, "payload": PAYLOAD | {"mass": 4.0}}
    faults = (
        {"kind": "payload_lost", "at": 2.0},
        {"kind": "payload_captured", "payload": PAYLOAD | {"mass": 8.0}, "at": 1.5},
        {"kind": "payload_captured", "payload": PAYLOAD | {"mass": 16.0}, "at": 3.0},
    )
    found = masses(composed(*faults, payload=PAYLOAD, capture=capture))
    empty = masses(composed())[0]
    assert {tick: round(mass - empty, 9) for tick, mass in found.items()} == {0: 2, 4: 6, 6: 14, 8: 0, 12: 16}


def test_a_shift_moves_the_centre_of_mass_and_no_mass() -> None:
    """Total mass and the masses of bodies stay, the hand's centre of mass is another."""
    composition = composed({"kind": "payload_shifted", "offset": [0.1, 0, 0], "at": 1.0}, payload=PAYLOAD)
    ((stamp, robot, _),) = [change for change in composition.changes if change[0] == 4 * T]
    before, after = composition.truth.model.inertias, robot.model.inertias
    assert [one.mass for one in after] == pytest.approx([one.mass for one in before])
    moved = [not np.allclose(a.lever, b.lever) for a, b in zip(before, after, strict=True)]
    assert sum(moved) == 1
    assert stamp == T * 4


def test_inertia_changes_by_its_factor() -> None:
    """Mass and inertia of the body are scaled, others stay; energy and momentum are balanced anew from there on."""
    composition = composed({"kind": "inertia_change", "body": "base_link", "factor": 0.8, "at": 2.0})
    ((_, robot, _),) = [change for change in composition.changes if change[0] == 8 * T]
    before, after = composition.truth.model.inertias[1], robot.model.inertias[1]
    assert after.mass == pytest.approx(0.8 * before.mass)
    np.testing.assert_allclose(after.inertia, 0.8 * before.inertia)
    for tick in run_in_memory(composition).ticks:
        assert tick.sample.telemetry["momentum_residual"].max() < 1e-12
        assert tick.sample.telemetry["energy_residual"].max() < 1e-12
