"""Tuning: the same evaluations however they are run, judged on draws that were not seen, and one line for bad input."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("cmaes")
pytest.importorskip("scipy")

import space_robot as sr
from space_robot_bringup.experiment.readable import dump_yaml
from space_robot_description.validation import parse_yaml
from space_robot_studies.engine.hooks import StudyHooks
from space_robot_studies.tune.outcome import TuningResult
from tests.support.nonempty import nonempty
from tests.support.paths import ROOT
from tests.support.tool import Tool, refused

TASK: dict[str, Any] = {
    "title": "A short move",
    "experiment": "compare/mini",
    "set": {"duration": 4.0, "reference.duration": 2.0, "reference.joints_by_deg": 2},
    "disperse": {"plant.payload.mass": {"uniform": {"low": 0.8, "high": 1.2}}},
    "vary": {"control_period": [0.25, 0.5]},
    "laws": {"computed_torque": {"gains": {"bandwidth": 0.3}}},
    "objective": {"minimise": {"joint_error": 1.0, "torque_integral": 0.01}},
    "budget": 12,
    "draws": 2,
    "held_out": 3,
    "seed": 4,
}
FILES = ("tuning.json", "evaluations.csv", "best/computed_torque-control_period-0.25.yaml")


def write(folder: Path, **changes: Any) -> Path:
    path = folder / "tuning.yaml"
    path.write_text(dump_yaml(TASK | changes), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def tuned(tmp_path_factory: pytest.TempPathFactory) -> TuningResult:
    """The task, tuned by one worker at a stretch."""
    folder = tmp_path_factory.mktemp("tuned")
    return sr.tune(write(folder), out=folder / "one", workers=1)


def contents(directory: Path) -> list[bytes]:
    return [(directory / name).read_bytes() for name in FILES]


def test_two_workers_and_a_resumed_search_give_the_same_evaluations(tuned: TuningResult, tmp_path: Path) -> None:
    """Every evaluation and the best gains are the same to the bit with two workers, stopped in between and resumed."""
    seen: list[int] = []
    hooks = StudyHooks(on_row=seen.append, stop=lambda: "interrupted" if len(seen) > 17 else None)
    path = write(tmp_path)
    begun = sr.tune(path, out=tmp_path / "two", workers=2, hooks=hooks)
    assert (begun.end_reason, begun.stands, begun.passed) == ("interrupted", (), False)
    assert not (tmp_path / "two" / "tuning.json").exists()
    rows = tmp_path / "two" / "rows.jsonl"
    before = rows.read_text().splitlines()
    # The last line is torn, as by a power cut.
    rows.write_text("\n".join([*before[:-1], before[-1][:40]]))
    resumed = sr.tune(path, out=tmp_path / "two", workers=2, resume=True)
    assert resumed.end_reason == "completed"
    assert contents(tmp_path / "two") == contents(tuned.directory)
    assert rows.read_text().splitlines()[: len(before) - 1] == before[:-1]


def test_the_best_gains_are_better_where_it_was_not_looked_for(tuned: TuningResult) -> None:
    """On held-out draws, of which none is a draw of the search, tuned gains are better than the shipped ones."""
    assert tuned.passed
    assert [stand.where for stand in tuned.stands] == [
        "computed_torque, control_period 0.25",
        "computed_torque, control_period 0.5",
    ]
    for stand in tuned.stands:
        assert len(stand.evaluations) == 12
        assert stand.evaluations[0].gains == {}
        assert stand.best.rank == min(one.rank for one in stand.evaluations)
        shipped, best = stand.held_out_shipped.estimate, stand.held_out_best.estimate
        assert shipped is not None
        assert best is not None
        assert best.high < shipped.low
        errors = [[draw["joint_error"] for draw in one.draws] for one in (stand.evaluations[0], stand.held_out_shipped)]
        assert not set(errors[0]) & set(errors[1])
        assert len(stand.neighbours) == 2 * len(stand.ranges)


def test_a_run_with_the_gains_to_paste_has_the_numbers_of_its_evaluation(tuned: TuningResult, tmp_path: Path) -> None:
    """The section in best/ put into the experiment gives, for the first draw, the error the table has."""
    (stand, *_) = tuned.stands
    data = parse_yaml(tuned.directory / "resolved.yaml")
    campaign = {key: data[key] for key in ("experiment", "disperse", "seed")} | {"runs": 5}
    campaign["vary"] = {"control_period": [0.25]}
    campaign["experiment"] |= parse_yaml(tuned.directory / FILES[2])
    (tmp_path / "campaign.yaml").write_text(dump_yaml(campaign))
    result = sr.campaign(tmp_path / "campaign.yaml", out=tmp_path / "out", workers=1)
    (group, *_) = result.groups
    errors = [draw["joint_error"] for one in (stand.best, stand.held_out_best) for draw in one.draws]
    largest = max(
        spread.max for name, spread in group.spreads.items() if name.endswith(".max_error") and "joint" in name
    )
    assert max(errors) == largest


def test_the_table_has_every_evaluation(tuned: TuningResult) -> None:
    """evaluations.csv has a row per evaluation, with point, numbers and gains."""
    with (tuned.directory / "evaluations.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == 24
    assert {row["control_period"] for row in rows} == {"0.25", "0.5"}
    for row, one in zip(nonempty(rows[:12]), tuned.stands[0].evaluations, strict=True):
        assert float(row["objective"]) == one.objective
        assert row["bandwidth"] == ("" if one.number == 0 else repr(one.gains["bandwidth"]))


def test_a_larger_budget_goes_on(tuned: TuningResult, tmp_path: Path) -> None:
    """Resumed with a larger budget the first evaluations stay; another task in the directory is refused."""
    path = write(tmp_path, vary={}, budget=5, held_out=1, draws=1)
    first = sr.tune(path, out=tmp_path / "out", workers=1)
    more = sr.tune(path, out=tmp_path / "out", workers=1, budget=7, resume=True)
    (one,), (other,) = first.stands, more.stands
    assert [e.gains for e in other.evaluations[:5]] == [e.gains for e in one.evaluations]
    assert len(other.evaluations) == 7
    write(tmp_path, vary={}, budget=7, held_out=1, draws=1, seed=5)
    with pytest.raises(sr.SpaceRobotError, match=r"not the same: seed"):
        sr.tune(path, out=tmp_path / "out", resume=True)


def test_a_law_of_a_user_is_tuned_like_a_shipped_one(space_robot: Tool, tmp_path: Path) -> None:
    """What examples/my_law.py declares in one line is searched; the page and the table name it."""
    pytest.importorskip("matplotlib")
    mine = f"{ROOT / 'examples' / 'my_law.py'}:PdPlus"
    write(tmp_path, laws={"mine": {"law": mine, "gains": {"bandwidth": 0.05}}}, vary={}, budget=4, held_out=1, draws=1)
    done = space_robot("tune", "tuning.yaml", "--out", "out", "--markdown", "table.md", "--workers", "1")
    assert done.returncode == 0, done.stderr
    assert "--set controller.gains.bandwidth=" in done.stdout
    section = parse_yaml(tmp_path / "out" / "best" / "mine.yaml")["controller"]
    assert section["law"] == mine
    assert 0.02 <= section["gains"]["bandwidth"] <= 2.0
    assert "| mine |" in (tmp_path / "table.md").read_text()
    page = (tmp_path / "out" / "index.html").read_text()
    assert page.count('<img src="data:image/png;base64,') == 1
    assert "bandwidth 0.02 to 2, log" in page


TIRED = """
from space_robot import GainRange, Law, SpaceRobotError

class Tired(Law):
    class Gains(Law.Gains):
        patience: float = 1.0

    gain_ranges = {"patience": GainRange(1.0, 2.0)}
    gains: Gains

    def compute(self, state, reference):
        raise ArithmeticError("enough")
"""
BAD: dict[str, tuple[dict[str, Any], tuple[str, ...]]] = {
    "an unknown key": ({"laws": {"pd": {"ranges": {}, "gain": {}}}}, ("laws.pd.gain", "gains")),
    "an unknown law": ({"laws": {"computed_torq": {}}}, ("laws.computed_torq.law", "computed_torque")),
    "an unknown gain": ({"laws": {"pd": {"ranges": {"bandwith": {"low": 1, "high": 2}}}}}, ("bandwith", "bandwidth")),
    "an unknown inner gain": (
        {"laws": {"ntsmc": {"ranges": {"gamma.joint": {"low": 1, "high": 2}}}}},
        ("laws.ntsmc.ranges.gamma.joint",),
    ),
    "an empty range": (
        {"laws": {"pd": {"ranges": {"bandwidth": {"low": 2, "high": 2}}}}},
        ("laws.pd.ranges.bandwidth",),
    ),
    "a range beyond a gain": (
        {"laws": {"pd": {"ranges": {"bandwidth": {"low": -1, "high": 2, "scale": "linear"}}}}},
        ("laws.pd.ranges.bandwidth", "-1"),
    ),
    "no gains to search": ({"laws": {"none": {}}}, ("laws.none.ranges", "gain_ranges")),
    "no laws": ({"laws": {}}, ("laws",)),
    "a law that is varied": ({"vary": {"controller.law": ["pd"]}}, ("vary.controller.law",)),
    "an unknown number": (
        {"objective": {"minimise": {"joint_eror": 1.0}}},
        ("objective.minimise.joint_eror", "joint_error"),
    ),
    "nothing to minimise": ({"objective": {"minimise": {}}}, ("objective",)),
    "a weight of nothing": ({"objective": {"minimise": {"joint_error": 0.0}}}, ("objective.minimise.joint_error", "0")),
    "an unknown constraint": ({"constraints": {"torque": 1.0}}, ("constraints.torque", "torque_integral")),
    "settling without bands": (
        {"objective": {"minimise": {"settling_time": 1.0}}, "experiment": "liu2023/fig08", "set": {"duration": 2.0}},
        ("objective.minimise.settling_time", "settling_bands"),
    ),
    "no budget": ({"budget": 0}, ("budget", "0")),
    "no draws": ({"draws": 0}, ("draws", "0")),
    "gains that cannot be run": ({"laws": {"pd": {"gains": {"bandwidth": -1}}}}, ("pd", "bandwidth", "-1")),
}


@pytest.mark.parametrize(("changes", "words"), BAD.values(), ids=BAD)
def test_a_bad_file_gets_one_line_and_leaves_nothing(
    space_robot: Tool, tmp_path: Path, changes: dict[str, Any], words: tuple[str, ...]
) -> None:
    """Every mistake is found before the first run: key, value and what would do, exit 2, nothing written."""
    write(tmp_path, **changes)
    refused(space_robot("tune", "tuning.yaml", "--out", "out"), *words)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--budget", "0"), ("--budget", "0")),
        (("--law", "pid"), ("--law", "pid", "computed_torque")),
        (("--workers", "0"), ("--workers", "0")),
        (("--out", "tuning.yaml"), ("--out", "tuning.yaml")),
        (("--markdown", "no/where.md"), ("--markdown", "no/where.md")),
    ],
)
def test_bad_options_get_one_line(
    space_robot: Tool, tmp_path: Path, options: tuple[str, ...], words: tuple[str, ...]
) -> None:
    """Options are checked before anything runs."""
    write(tmp_path)
    refused(space_robot("tune", "tuning.yaml", *options), *words)


def test_an_objective_that_is_never_finite_is_said_in_one_line(space_robot: Tool, tmp_path: Path) -> None:
    """Where no evaluation completes, the end of the first one is named, exit 2; what was run is kept."""
    (tmp_path / "tired.py").write_text(TIRED)
    write(tmp_path, laws={"tired": {"law": "tired.py:Tired"}}, vary={}, budget=3, held_out=1, draws=1)
    done = space_robot("tune", "tuning.yaml", "--out", "out", "--workers", "1", "--json")
    refused(done, "objective", "tired", "enough")
    assert len((tmp_path / "out" / "rows.jsonl").read_text().splitlines()) == 4


def test_json_has_what_the_files_have(space_robot: Tool, tmp_path: Path) -> None:
    """--json prints one object, and --law and --budget bound what is searched."""
    laws = {"computed_torque": {}, "pd": {}}
    write(tmp_path, laws=laws, vary={}, held_out=1, draws=1)
    options = ("--law", "pd", "--budget", "2", "--json", "--out", "out", "--workers", "1")
    done = space_robot("tune", "tuning.yaml", *options)
    said = json.loads(done.stdout)
    assert said == json.loads((tmp_path / "out" / "tuning.json").read_text())
    assert [(stand["law"], stand["evaluations"]) for stand in said["stands"]] == [("pd", 2)]
