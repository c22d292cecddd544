"""Run k of a campaign is a function of the campaign and k alone."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

from space_robot_bringup.experiment.dotted_keys import set_key
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_description.rotations import from_rpy, log, matrix
from space_robot_description.share import shipped
from space_robot_description.validation import parse_yaml_text
from space_robot_msgs_py.errors import SpecError
from space_robot_studies.campaign.cases import check_cases, make_case
from space_robot_studies.campaign.directory import to_yaml
from space_robot_studies.campaign.distributions import Draw
from space_robot_studies.campaign.spec import Campaign, load_campaign

DISPERSE: dict[str, Any] = {
    "initial.attitude_deg": {"uniform": {"low": [-5, -5, 0], "high": [5, 5, 0]}},
    "plant.sensors.attitude.noise": {"normal": {"mean": 1e-3, "std": 1e-4}},
    "plant.delay_periods": {"choice": [0, 1]},
}


def campaign(**changes: Any) -> Campaign:
    """A resolved campaign of fig08."""
    experiment = load_experiment("liu2023/fig08").model_dump(mode="json")
    return Campaign.model_validate({"experiment": experiment, "runs": 20, "disperse": DISPERSE, "seed": 3} | changes)


def drawn(spec: Campaign, index: int) -> dict[str, Any]:
    return dict(make_case(spec, index).drawn)


@pytest.mark.parametrize("name", shipped("campaigns"))
def test_every_shipped_campaign_can_be_run(name: str) -> None:
    """All its cases are experiments, and its extremes compose."""
    spec = load_campaign(name)
    assert spec.title
    assert check_cases(spec)


@pytest.mark.parametrize("name", shipped("campaigns"))
def test_a_resolved_campaign_is_the_campaign(tmp_path: Path, name: str) -> None:
    """The resolved YAML, read back, is the same campaign with the same cases: it needs no other file."""
    first = load_campaign(name)
    (tmp_path / "again.yaml").write_text(to_yaml(first), encoding="utf-8")
    again = load_campaign(str(tmp_path / "again.yaml"))
    assert again == first
    assert make_case(again, 7) == make_case(first, 7)


def test_streams_are_the_children_that_spawn_makes() -> None:
    """Case k draws from child k of SeedSequence.spawn, so that cases are independent and none needs the others."""
    children = np.random.SeedSequence(3).spawn(20)
    for index in (0, 7, 19):
        seed = int(children[index].generate_state(1, np.uint64)[0] >> np.uint64(11))
        assert make_case(campaign(), index).seed == seed


def test_cases_depend_on_nothing_but_the_campaign_and_their_index() -> None:
    """More runs, another order of keys or a further key change no draw; another seed changes all."""
    spec = campaign()
    turned = campaign(disperse=dict(reversed(DISPERSE.items())))
    further = campaign(disperse=DISPERSE | {"initial.position": {"direction": {"low": 0, "high": 1}}}, runs=50)
    other = campaign(seed=4)
    for index in range(spec.cases):
        here = drawn(spec, index)
        assert drawn(turned, index) == here
        assert {key: drawn(further, index)[key] for key in here} == here
        assert make_case(further, index).seed == make_case(spec, index).seed
        assert drawn(other, index)["initial.attitude_deg"] != here["initial.attitude_deg"]
    assert len({make_case(spec, index).seed for index in range(20)}) == 20


def test_points_of_a_grid_get_the_same_draws() -> None:
    """Every combination is run with the same draws and seeds, and more runs renumber no case."""
    vary = {"plant.hold": ["last", "zero"], "controller": {"soft": {"gains": {"bandwidth": 0.5}}, "hard": {}}}
    spec = campaign(vary=vary, runs=3)
    cases = [make_case(spec, index) for index in range(spec.cases)]
    assert len(cases) == 12
    for run in range(3):
        four = cases[4 * run : 4 * run + 4]
        assert all(case.drawn == four[0].drawn and case.seed == four[0].seed for case in four)
        assert [case.labels["controller"] for case in four] == ["soft", "hard", "soft", "hard"]
        assert [case.experiment().plant.hold for case in four] == ["last", "last", "zero", "zero"]
        assert four[0].experiment().controller.gains == {"bandwidth": 0.5}
    assert make_case(campaign(vary=vary, runs=9), 10) == cases[10]


def test_a_key_may_repeat_what_is_drawn_for_another() -> None:
    """``same_as`` gives the value of the other key; a chain, a loop or an unknown key is refused."""
    again = {"controller.gains.start_deg": {"same_as": "initial.attitude_deg"}}
    values = drawn(campaign(disperse=again | DISPERSE), 4)
    assert (
        values["controller.gains.start_deg"]
        == values["initial.attitude_deg"]
        == drawn(campaign(), 4)["initial.attitude_deg"]
    )
    for wrong in ({"title": {"same_as": "titel"}}, {"title": {"same_as": "title"}}):
        with pytest.raises(ValidationError, match="drawn by itself"):
            campaign(disperse=wrong)


def test_a_given_seed_is_the_seed_of_the_case() -> None:
    """A varied or dispersed seed takes the place of the drawn one."""
    assert make_case(campaign(vary={"seed": [5, 6]}), 1).experiment().seed == 6
    assert make_case(campaign(disperse={"seed": {"choice": [8]}}), 2).experiment().seed == 8


def samples(draw: dict[str, Any], count: int = 2000) -> np.ndarray[Any, np.dtype[Any]]:
    spec = Draw.model_validate(draw)
    return np.array([spec.sample(np.random.default_rng([index, 1])) for index in range(count)])


def test_draws_have_the_distribution_they_say() -> None:
    """Bounds hold, means and deviations are those asked for, choices are equally likely, lists are independent."""
    flat = samples({"uniform": {"low": [-1, 2], "high": [1, 2]}})
    assert np.abs(flat[:, 0]).max() <= 1
    assert flat[:, 0].std() == pytest.approx(1 / np.sqrt(3), rel=0.05)
    assert (flat[:, 1] == 2).all()
    bell = samples({"normal": {"mean": [1, -1], "std": 0.5}})
    assert bell.mean(axis=0) == pytest.approx([1, -1], abs=0.05)
    assert np.cov(bell.T) == pytest.approx(np.diag([0.25, 0.25]), abs=0.03)
    assert np.mean(samples({"choice": [0, 1]})) == pytest.approx(0.5, abs=0.05)


def test_directions_and_rotations_prefer_none() -> None:
    """Directions average to zero, rotations by up to 180 deg to the zero matrix; smaller ones keep their bound."""
    spread = samples({"direction": {"low": 2.0, "high": 2.0}})
    assert np.linalg.norm(spread, axis=1) == pytest.approx(np.full(2000, 2.0))
    assert np.abs(spread.mean(axis=0)).max() < 0.1
    attitudes = np.radians(samples({"rotation": {"max_deg": 180}}))
    assert np.abs(np.mean([matrix(from_rpy(rpy)) for rpy in attitudes], axis=0)).max() < 0.06
    near = np.radians(samples({"rotation": {"max_deg": 20}}))
    angles = np.degrees([np.linalg.norm(log(from_rpy(rpy))) for rpy in near])
    assert angles.max() <= 20 + 1e-9
    # Small rotations fill a ball evenly: half of them lie within 2^(-1/3) of its radius.
    assert np.median(angles) == pytest.approx(20 * 0.5 ** (1 / 3), rel=0.02)


def test_keys_reach_into_lists_and_past_dots() -> None:
    """A dotted key finds items of lists and names that have dots themselves, and never leads through a value."""
    data: dict[str, Any] = parse_yaml_text("a: {b: [1, {c: 2}], d: null}\ne: {x.y: {max: 1}}\n", "test")
    for key, value in {"a.b.1.c": 3, "a.b.0": 4, "a.d.new": 5, "e.x.y.max": 6, "f.g": 7}.items():
        set_key(data, key, value, key)
    assert data == {
        "a": {"b": [4, {"c": 3}], "d": {"new": 5}},
        "e": {"x.y": {"max": 6}},
        "f": {"g": 7},
    }
    for key in ("a.b.2", "a.b.0.c", "f.g.h", "a.b.-1"):
        with pytest.raises(SpecError, match="no section"):
            set_key(data, key, 0, key)
