"""From a manifest to runs: every combination once, under a name and with a command of its own."""

from __future__ import annotations

import json
import shlex
from pathlib import Path
from typing import Any

import pytest

from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.experiment.readable import dump_yaml
from space_robot_description.validation import parse_yaml_text
from space_robot_msgs_py.errors import SpecError
from space_robot_studies.campaign.cases import make_case
from space_robot_studies.campaign.spec import load_campaign
from space_robot_studies.reproduce.plan import Plan, choose_figures, load_plan, picture_name

HEAD = "title: T\ncitation: C\nfigures:\n"
PERIOD = "control_period"


def plan(folder: Path, *figures: str) -> Plan:
    """A plan from the ``runs`` of its figures a, b, ..."""
    body = "".join(f"  {name}: {{title: t, runs: {{{runs}}}}}\n" for name, runs in zip("abc", figures, strict=False))
    (folder / "p.yaml").write_text(HEAD + body)
    return load_plan(str(folder / "p.yaml"))


def test_varied_values_and_seeds_are_combined(tmp_path: Path) -> None:
    """One run per combination, seeds innermost, labelled by what varies."""
    made = plan(tmp_path, f"l: {{experiment: liu2023/fig08, vary: {{{PERIOD}: [0.25, 0.5]}}, seeds: [3, 5]}}")
    runs = made.runs["a"]["l"]
    want = [f"l control_period {period}, seed {seed}" for period in (0.25, 0.5) for seed in (3, 5)]
    assert [run.label for run in runs] == want
    assert [run.values for run in runs][1] == {PERIOD: 0.25, "seed": 5}
    assert [run.distinct.experiment.seed for run in runs] == [3, 5, 3, 5]
    assert len(made.distinct_runs(["a"])) == 4


def test_one_varying_key_is_labelled_by_its_value_alone(tmp_path: Path) -> None:
    """Labels are short: the group and the value, and the group alone for a single run."""
    groups = (
        "prior: {experiment: liu2023/fig08, set: {nominal.dispersion.eta: 0.2}, seeds: {first: 1, count: 3}}",
        f"l: {{experiment: liu2023/fig08, vary: {{{PERIOD}: [0.25, 0.5]}}, seeds: [4]}}",
        "real: {experiment: liu2023/fig08}",
    )
    labels = [run.label for group in plan(tmp_path, ", ".join(groups)).runs["a"].values() for run in group]
    assert labels == ["prior 1", "prior 2", "prior 3", "l 0.25", "l 0.5", "real"]


def test_equal_runs_are_done_once_whatever_they_are_called(tmp_path: Path) -> None:
    """Two figures that show the same experiment share its run, also when it is said in another way."""
    made = plan(
        tmp_path,
        "real: {experiment: liu2023/fig08}",
        f"varied: {{experiment: liu2023/fig08, vary: {{{PERIOD}: [0.25, 0.5], seed: [0]}}}}",
    )
    assert made.runs["a"]["real"][0].distinct is made.runs["b"]["varied"][0].distinct
    assert len(made.distinct_runs(["a", "b"])) == 2


def test_different_runs_have_different_names(tmp_path: Path) -> None:
    """Names of bags are unique, fit a file system and do not depend on the figures chosen."""
    long = {f"plant.sensors.{name}.noise": 1e-6 for name in ("position", "attitude", "angular_velocity")}
    groups = (
        'x: {experiment: liu2023/fig08, set: {title: "a/b"}}, y: {experiment: liu2023/fig08, set: {title: "a b"}}',
        f"z: {{experiment: liu2023/fig08, set: {long!r}, seeds: [1, 2]}}",
    )
    runs = plan(tmp_path, *groups).distinct_runs(["a", "b"])
    assert len(runs) == 4
    assert all(len(name) < 100 and "/" not in name and " " not in name for name in runs)
    assert set(plan(tmp_path, *groups).distinct_runs(["b"])) < set(runs)


@pytest.mark.parametrize(
    "values",
    [
        {"controller.gains.anything": 1e-05},
        {"controller": {"law": "none", "gains": {}}},
        {"title": 'it\'s "quoted": $HOME # no comment'},
        {"reference.joints_deg": [90, 55, 55.5, -1]},
        {"nominal.dispersion.eta": 0.1, "seed": 7},
    ],
)
def test_the_command_gives_the_experiment_that_is_run(tmp_path: Path, values: dict[str, Any]) -> None:
    """What a shell makes of the command is the planned experiment, every value of it."""
    (run,) = plan(tmp_path, f"x: {{experiment: liu2023/fig08, set: {json.dumps(values)}}}").runs["a"]["x"]
    program, verb, argument, *options = shlex.split(run.distinct.command)
    assert (program, verb) == ("space-robot", "run")
    assert options[::2] == ["--set"] * len(values)
    assert load_experiment(argument, options[1::2]) == run.distinct.experiment


def test_an_experiment_beside_the_manifest_is_found(tmp_path: Path) -> None:
    """A manifest and its experiments move together."""
    (tmp_path / "mine.yaml").write_text(
        "robot: mini\ncontrol_period: 0.25\nduration: 1.0\nreference: {kind: hold}\ninitial: {joints_deg: 20}\n"
    )
    (run,) = plan(tmp_path, "x: {experiment: mine.yaml}").runs["a"]["x"]
    assert run.distinct.argument == str(tmp_path / "mine.yaml")
    assert run.distinct.experiment.duration == 1.0


@pytest.mark.parametrize(
    ("runs", "words"),
    [
        ("x: {experiment: liu2023/fig8}", ("p.yaml figures.a.runs.x", "liu2023/fig08")),
        ("x: {experiment: liu2023/fig08, set: {contol_period: 1}}", ("figures.a.runs.x", "control_period")),
        ("x: {experiment: liu2023/fig08, vary: {seed: [1]}, seeds: [1]}", ("figures.a.runs.x", "given twice")),
        ("x: {experiment: liu2023/fig08, seeds: [1, 1]}", ("figures.a.runs.x", "twice")),
        ("x: {experiment: liu2023/fig08, seeds: [-1]}", ("figures.a.runs.x.seeds.0", "-1")),
        ("x: {experiment: liu2023/fig08, vary: {seed: []}}", ("figures.a.runs.x", "vary.seed has no value")),
        ("x: {experiment: liu2023/fig08, set: {a=b: 1}}", ("figures.a.runs.x", "'a=b'")),
        ("x: {experiment: liu2023/fig08, seeds: {count: 1000000}}", ("figures.a.runs.x.seeds", "10000")),
        ("x: {experiment: liu2023/fig08, vary: {duration: [1, 2]}, seeds: {count: 9999}}", ("at most 10000 runs",)),
        ("x: {experiment: liu2023/fig08, sweep: {seed: [1]}}", ("figures.a.runs.x.sweep", "was renamed", "vary")),
        ("x: {campaign: fig08_dispersed, at: {seed: 1}}", ("figures.a.runs.x.at", "was renamed", "where")),
        ("x: {experiment: liu2023/fig08, runs: 3}", ("figures.a.runs.x", "disperse")),
        ("x: {experiment: liu2023/fig08, disperse: {seed: {choice: [1, 2]}}}", ("figures.a.runs.x", "runs or seeds")),
        (
            "x: {experiment: liu2023/fig08, disperse: {seed: {chioce: [1]}}, runs: 2}",
            ("figures.a.runs.x.disperse.seed.chioce", "choice"),
        ),
        ("x: {campaign: fig08_dispersed, disperse: {seed: {choice: [1]}}}", ("figures.a.runs.x", "draws")),
        ("x: {experiment: liu2023/fig08, vry: {}}", ("figures.a.runs.x.vry", "vary")),
        ("", ("figures.a.runs",)),
    ],
)
def test_bad_groups_are_refused_by_their_key(tmp_path: Path, runs: str, words: tuple[str, ...]) -> None:
    """One line names the key path and what would do."""
    with pytest.raises(SpecError) as refusal:
        plan(tmp_path, runs)
    for word in words:
        assert word in str(refusal.value)


def test_every_figure_has_a_picture_of_its_own(tmp_path: Path) -> None:
    """Two figures whose pictures would have one file name are refused."""
    assert picture_name("8") == "fig08.png"
    assert picture_name("table 2/b") == "table-2-b.png"
    body = "".join(f'  "{name}": {{title: t, runs: {{x: {{experiment: liu2023/fig08}}}}}}\n' for name in ("8", "fig08"))
    (tmp_path / "p.yaml").write_text(HEAD + body)
    with pytest.raises(SpecError, match=r"p\.yaml figures: its picture is that of '8'; got 'fig08'"):
        load_plan(str(tmp_path / "p.yaml"))


def test_figures_are_chosen_in_the_order_of_the_manifest(tmp_path: Path) -> None:
    """All by default; a figure that is not there suggests the nearest; 8 and "8" are the same."""
    (tmp_path / "p.yaml").write_text(HEAD + "  8: {title: t, runs: {x: {experiment: liu2023/fig08}}}\n")
    assert choose_figures(load_plan(str(tmp_path / "p.yaml")).manifest, ["8"]) == ["8"]
    runs = "x: {experiment: liu2023/fig08}"
    manifest = plan(tmp_path, runs, runs).manifest
    assert choose_figures(manifest, []) == ["a", "b"]
    assert choose_figures(manifest, ["b", "a"]) == ["a", "b"]
    with pytest.raises(SpecError, match=r"--figure: no such figure; got 'd'"):
        choose_figures(manifest, ["d"])


CAMPAIGN = """
experiment: liu2023/fig08
set: {duration: 2.0, expect: {}}
runs: 3
seed: 5
disperse:
  initial.attitude_deg: {rotation: {max_deg: 20}}
  reference.joints_deg: {uniform: {low: [80, 50, 50, 0], high: [90, 60, 60, 5]}}
  plant.sensors.attitude.noise: {uniform: {low: 0.0, high: 1.0e-4}}
vary:
  plant.delay_periods: [0, 1]
  controller.gains: {soft: {lambda: 0.5}, hard: {lambda: 1.0}}
"""


def test_the_cases_of_a_campaign_become_its_runs(tmp_path: Path) -> None:
    """Each run is the experiment of its case, with the robot by name; the command gives it; labels tell them apart."""
    (tmp_path / "c.yaml").write_text(CAMPAIGN)
    campaign = load_campaign(str(tmp_path / "c.yaml"))
    runs = plan(tmp_path, "x: {campaign: c.yaml, where: {plant.delay_periods: 1}}").runs["a"]["x"]
    labels = [f"x gains {gains}, run {number}" for gains in ("soft", "hard") for number in range(3)]
    assert [run.label for run in runs] == labels
    for run, point in zip(runs, [2, 2, 2, 3, 3, 3], strict=True):
        case = make_case(campaign, run.values["run"] * 4 + point)
        want = case.experiment().model_copy(update={"robot": "mini"})
        assert run.distinct.experiment == want
        _, _, argument, *options = shlex.split(run.distinct.command)
        assert load_experiment(argument, options[1::2]) == want
        assert (run.seed, run.source) == (case.seed, ("draw", case.run))
    assert {run.values["controller.gains"] for run in runs} == {"soft", "hard"}
    assert len({run.distinct.name for run in runs}) == 6


def test_set_and_runs_of_a_campaign_change_no_draw(tmp_path: Path) -> None:
    """``set`` comes last, ``runs`` takes the first of the campaign's runs: partners keep their draws and seeds."""
    (tmp_path / "c.yaml").write_text(CAMPAIGN)
    where = "where: {plant.delay_periods: 0, controller.gains: soft}"
    made = plan(
        tmp_path,
        f"x: {{campaign: c.yaml, {where}}}, "
        f"y: {{campaign: c.yaml, runs: 2, {where}, set: {{controller.gains.lambda: 3}}}}",
    ).runs["a"]
    for x, y in zip(made["x"], made["y"], strict=False):
        assert x.distinct.experiment.initial == y.distinct.experiment.initial
        assert (x.seed, x.label.replace("x", "y")) == (y.seed, y.label)
    assert [run.distinct.experiment.controller.gains for run in made["y"]] == [{"lambda": 3}] * 2


def test_a_group_that_disperses_is_a_campaign_of_its_own(tmp_path: Path) -> None:
    """The keys of a campaign in a group give the runs of that campaign: experiments, labels, seeds and values."""
    (tmp_path / "c.yaml").write_text(CAMPAIGN)
    keys = ", ".join(line for line in CAMPAIGN.split("disperse:")[0].split("\n") if line)
    body = json.dumps({name: parse_yaml_text(CAMPAIGN, "c")[name] for name in ("disperse", "vary")})[1:-1]
    made = plan(tmp_path, f"x: {{campaign: c.yaml}}, y: {{{keys}, {body}}}").runs["a"]
    assert len(made["x"]) == 12
    for x, y in zip(made["x"], made["y"], strict=True):
        assert x.distinct is y.distinct
        assert (x.label.replace("x", "y", 1), x.values, x.source) == (y.label, y.values, y.source)


def test_seeds_of_a_campaign_are_those_of_its_runs(tmp_path: Path) -> None:
    """With ``seeds`` runs have these seeds, in order, and the same draws as without; ``runs`` takes the first."""
    (tmp_path / "c.yaml").write_text(CAMPAIGN)
    (tmp_path / "s.yaml").write_text(CAMPAIGN.replace("runs: 3", "seeds: {first: 7, count: 3}"))
    drawn, listed = load_campaign(tmp_path / "c.yaml"), load_campaign(tmp_path / "s.yaml")
    assert (listed.runs, listed.cases) == (3, 12)
    for index in range(12):
        case = make_case(listed, index)
        assert case.seed == case.experiment().seed == 7 + index // 4
        assert case.drawn == make_case(drawn, index).drawn
    assert load_campaign(tmp_path / "s.yaml", 2).cases == 8
    with pytest.raises(SpecError, match="4 runs, but 3 seeds"):
        load_campaign(tmp_path / "s.yaml", 4)


def test_labels_stand_for_varied_values(tmp_path: Path) -> None:
    """As in a campaign, a label names its value in runs, and the value is what is run."""
    vary = "vary: {controller.gains: {soft: {lambda: 0.5}, hard: {lambda: 2.0}}}"
    runs = plan(tmp_path, f"x: {{experiment: liu2023/fig08, {vary}}}").runs["a"]["x"]
    assert [run.label for run in runs] == ["x soft", "x hard"]
    assert [run.values["controller.gains"] for run in runs] == ["soft", "hard"]
    assert [run.distinct.experiment.controller.gains for run in runs] == [{"lambda": 0.5}, {"lambda": 2.0}]


@pytest.mark.parametrize(
    ("group", "words"),
    [
        ("campaign: fig08_dispersd", ("figures.a.runs.x", "fig08_dispersed")),
        ("campaign: c.yaml, experiment: liu2023/fig08", ("figures.a.runs.x", "experiment or campaign")),
        ("campaign: c.yaml, seeds: [1]", ("figures.a.runs.x", "runs and where")),
        ("campaign: c.yaml, runs: 0", ("figures.a.runs.x.runs", "0")),
        ("campaign: c.yaml, where: {plant.delay_periods: 2}", ("figures.a.runs.x.where", "plant.delay_periods")),
        ("experiment: liu2023/fig08, where: {plant.delay_periods: 0}", ("figures.a.runs.x", "campaign")),
        ("campaign: whole.yaml", ("figures.a.runs.x.campaign", "names one")),
    ],
)
def test_bad_campaign_groups_are_refused_by_their_key(tmp_path: Path, group: str, words: tuple[str, ...]) -> None:
    """A campaign that is not there, or is asked for what it does not have, is one line."""
    (tmp_path / "c.yaml").write_text(CAMPAIGN)
    experiment = dump_yaml({"experiment": load_experiment("liu2023/fig08").model_dump(mode="json"), "runs": 1})
    (tmp_path / "whole.yaml").write_text(experiment)
    with pytest.raises(SpecError) as refusal:
        plan(tmp_path, f"x: {{{group}}}")
    for word in words:
        assert word in str(refusal.value)
