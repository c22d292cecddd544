"""Numbers that the manifest of Song et al. (2023) states are those of the robot and the settings that are run."""

from __future__ import annotations

import re
from math import radians, sqrt

import numpy as np
import pinocchio as pin
import pytest

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import Experiment, load_experiment
from space_robot_control.laws.mfac.law import ModelFree
from space_robot_studies.reproduce.manifest import Manifest
from space_robot_studies.reproduce.plan import manifest_path, read_manifest

CASES = {"6-9": "attitude_6_85", "10-13": "attitude_1_7", "14-17": "position_1036", "18-21": "position_874"}
MARKED = {
    "MFAC, 6.85 deg": "attitude_6_85",
    "printed, 6.85 deg": "attitude_6_85_printed",
    "MFAC, positions": "position_1036",
    "printed, positions": "position_1036_printed",
}


@pytest.fixture(scope="module")
def manifest() -> Manifest:
    return read_manifest(manifest_path("song2023"), "song2023")


@pytest.fixture(scope="module")
def pair() -> tuple[float, float]:
    """Mass [kg] and inertia about z through the centre of mass [kg m2] of the pair, its grasp at rest."""
    robot = compose(load_experiment("song2023/attitude_6_85")).truth
    data = robot.model.createData()
    pin.ccrba(robot.model, data, pin.neutral(robot.model), np.zeros(robot.model.nv))
    return float(data.Ig.mass), float(data.Ig.inertia[2, 2])


@pytest.mark.parametrize("figure", CASES)
def test_printed_bounds_are_those_of_a_rigid_pair(manifest: Manifest, pair: tuple[float, float], figure: str) -> None:
    """Half the way at full thrust, half back; into a band: to its far edge, less the time inside."""
    mass, moment = pair
    experiment = load_experiment(f"song2023/{CASES[figure]}")
    initial, asked = experiment.initial, experiment.reference.model_dump()
    if figure in ("6-9", "10-13"):
        inertia, distance, band = moment, radians(initial.attitude_deg[2]), radians(0.2)
    else:
        inertia, distance, band = mass, abs(initial.position[0] - asked["position"][0]), 0.01
    to_rest = 2.0 * sqrt(inertia * distance / 0.1)
    into_band = 2.0 * sqrt(inertia * (distance + band) / 0.1) - 2.0 * sqrt(inertia * band / 0.1)
    (table,) = manifest.figures[figure].tables
    said = re.search(r"bound is ([\d.]+) s to rest, ([\d.]+) s into the band", table.title)
    assert said is not None
    assert [float(said[1]), float(said[2])] == pytest.approx([to_rest, into_band], abs=0.05)


def test_marks_of_the_map_are_the_settings_of_the_runs(manifest: Manifest, pair: tuple[float, float]) -> None:
    """Every mark stands at phi^2 / lambda and rho_3 of the experiment it names, and its lead is the map's."""
    found = {text: (one, mark) for one in manifest.figures["stability"].maps for text, mark in one.marks.items()}
    for text, name in MARKED.items():
        wanted, mark = found[text]
        ratio, rho, lead = _settings(load_experiment(f"song2023/{name}"), pair)
        assert mark.ratio == pytest.approx(ratio, rel=0.01), text
        assert mark.rho == pytest.approx(rho, rel=0.01), text
        assert wanted.lead == pytest.approx(lead), text


def _settings(experiment: Experiment, pair: tuple[float, float]) -> tuple[float, float, float]:
    """phi^2 / lambda, rho_3 and lead in periods of the first channel, from the gains and the pair."""
    law = compose(experiment).controller()
    assert isinstance(law, ModelFree)
    gains, period = law.gains, experiment.control_period
    lead = gains.lead["x"] if isinstance(gains.lead, dict) else gains.lead
    assert lead is not None
    along_x = law.channels.names[0] == "x"
    response = 1000.0 / pair[0] if along_x else np.degrees(1.0) / pair[1]
    phi = response * period * (lead + 0.5 * period)
    ratio = phi**2 / gains.control_weight if gains.units == "printed" else 1.0 / gains.kappa
    rho = gains.rho if gains.rho is not None else 0.25 / (1.0 + gains.kappa)
    return float(ratio), rho, lead / period
