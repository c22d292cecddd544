"""Laws side by side: the same draws for each, the numbers of the campaign's table, and failures that are shown."""

from __future__ import annotations

import json
from pathlib import Path
from statistics import median
from typing import Any

import pytest

pytest.importorskip("scipy")
pq = pytest.importorskip("pyarrow.parquet")

from space_robot_cli.main import main  # noqa: E402
from space_robot_studies.campaign.spec import load_campaign, read_campaign  # noqa: E402
from space_robot_studies.compare.comparison import METRICS, Comparison, side_by_side  # noqa: E402
from space_robot_studies.compare.tables import markdown, rows_of  # noqa: E402
from tests.support.nonempty import nonempty  # noqa: E402
from tests.support.tool import Tool, refused  # noqa: E402

pytestmark = pytest.mark.xdist_group("campaign")

# Short and of few runs; a law that never moves, and one that ends its run.
CAMPAIGN = """
title: four laws
experiment: compare/mini
set: {duration: 8.0, reference.duration: 4.0, reference.joints_by_deg: 2, reference.attitude_deg: [1, -1, 2]}
runs: 2
seed: 3
disperse:
  initial.angular_velocity: {direction: {low: 0.0, high: 0.002}}
  plant.payload.mass: {uniform: {low: 0.8, high: 1.2}}
vary:
  controller:
    torque: {law: computed_torque, gains: {bandwidth: 1.0}}
    mfac: {law: mfac, gains: {lead: 1.0, kappa: 1.0}}
    nothing: {law: none}
    gives_up: {law: "tests.support.laws:GivesUp"}
  control_period: [0.25, 0.5]
  nominal.payload_known: {"yes": 1.0, "no": 0.0}
"""


def call(monkeypatch: pytest.MonkeyPatch, *arguments: str) -> int:
    monkeypatch.setattr("sys.argv", ["space-robot", *arguments])
    with pytest.raises(SystemExit) as end:
        main()
    return int(end.value.code or 0)


@pytest.fixture(scope="module")
def finished_comparison(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The comparison run once through the command line."""
    folder = tmp_path_factory.mktemp("compare")
    (folder / "four.yaml").write_text(CAMPAIGN, encoding="utf-8")
    with pytest.MonkeyPatch.context() as patch:
        options = ("--workers", "1", "--markdown", str(folder / "all.md"))
        assert call(patch, "compare", str(folder / "four.yaml"), "--out", str(folder / "out"), *options) == 0
    return folder


def rows(folder: Path) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = pq.read_table(folder / "out" / "four" / "table.parquet").to_pylist()
    return found


def compared(folder: Path) -> Comparison:
    return side_by_side(load_campaign(folder / "four.yaml"), "four", rows(folder))


def test_every_law_gets_the_same_draws(finished_comparison: Path) -> None:
    """Seed, payload and first rates of run k are the same under every law, at every period, in every condition."""
    drawn = [
        name
        for name in rows(finished_comparison)[0]
        if name == "seed" or name.startswith(("initial.", "plant.payload"))
    ]
    assert len(drawn) == 5
    for run in (0, 1):
        assert len({tuple(row[name] for name in drawn) for row in rows(finished_comparison) if row["run"] == run}) == 1


def test_the_numbers_are_those_of_the_campaigns_table(finished_comparison: Path) -> None:
    """Every median is that of the completed rows of its law, period and condition; what is written says the same."""
    comparison = compared(finished_comparison)
    for cell in nonempty(comparison.cells):
        place = {"controller": cell.law, "control_period": cell.period, **cell.condition}
        mine = [row for row in rows(finished_comparison) if place.items() <= row.items()]
        done = [row for row in mine if row["completed"]]
        assert (cell.runs, cell.ended) == (len(mine), len(mine) - len(done)) == (2, len(mine) - len(done))
        for metric, name in (("torque_integral", "effort_integral"), ("saturation_share", "saturation_share")):
            assert cell.medians[metric] == (median(row[name] for row in done) if done else None)
        worst = [max(row[f"joint{index}.max_error"] for index in (1, 2, 3, 4)) for row in done]
        assert cell.medians["joint_error"] == (median(worst) if done else None)
    written = json.loads((finished_comparison / "out" / "compare.json").read_text(encoding="utf-8"))
    assert written == json.loads(json.dumps({"comparisons": [comparison.to_dict()]}))


def test_a_failed_law_has_a_row_in_every_table(finished_comparison: Path) -> None:
    """A law that never settles, and one that ends its runs, have a row in every table that says so."""
    comparison = compared(finished_comparison)
    for metric in METRICS:
        texts = {row[0]: row[2] for row in rows_of(comparison, metric)}
        assert set(texts) == {"torque", "mfac", "nothing", "gives_up"}
        assert texts["gives_up"] == "0/2, ended 2"
        assert "0/2" in texts["nothing"]
        assert "/" not in texts["torque"]
    (reason,) = comparison.cell("gives_up", 0.25, comparison.conditions[0]).reasons
    assert reason.startswith("controller: ")


def test_all_tables_are_written_and_drawn(finished_comparison: Path) -> None:
    """The Markdown file has every metric and, marked as wall clock, what a cycle costs; there is a picture."""
    text = (finished_comparison / "all.md").read_text(encoding="utf-8")
    assert all(what in text for what in METRICS.values())
    assert "wall clock" in text
    lines = [line for line in text.splitlines() if line.startswith("| ")]
    assert len({line.count("|") for line in lines}) == 2  # metrics and costs
    assert (finished_comparison / "out" / "four.png").read_bytes().startswith(b"\x89PNG")
    comparison = compared(finished_comparison)
    assert "| torque | 12 |" in markdown([comparison], {"four": {"torque": 12.4, "gives_up": None}})


def test_a_finished_comparison_is_shown_again(
    finished_comparison: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """With ``--resume`` nothing is run twice and the numbers are the same bits."""
    files = [finished_comparison / "out" / "compare.json", finished_comparison / "out" / "four" / "rows.jsonl"]
    before = [file.read_bytes() for file in files]
    again = ("--out", str(finished_comparison / "out"), "--resume", "--workers", "1", "--json")
    assert call(monkeypatch, "compare", str(finished_comparison / "four.yaml"), *again) == 0
    assert [file.read_bytes() for file in files] == before
    said = json.loads(capsys.readouterr().out)
    assert said["comparisons"] == json.loads(before[0])["comparisons"]
    assert said["costs_us"]["four"]["torque"] > 0.0
    assert said["costs_us"]["four"].keys() == {"torque", "mfac", "nothing", "gives_up"}


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("missing.yaml",), ("missing.yaml", "no such campaign")),
        (("fig08_dispersed",), ("fig08_dispersed vary", "controller")),
        (("bands.yaml",), ("settling_bands", "band for every axis")),
        (("four.yaml", "four.yaml"), ("twice",)),
        (("four.yaml", "--metric", "beauty"), ("--metric", "beauty", "settling_time")),
        (("four.yaml", "--markdown", "nowhere/all.md"), ("--markdown", "nowhere")),
        (("four.yaml", "--runs", "0"), ("runs", "0")),
        (("four.yaml", "--workers", "0"), ("--workers", "0")),
        (("four.yaml", "--out", "four.yaml"), ("four.yaml",)),
    ],
)
def test_a_campaign_that_cannot_be_compared_is_refused(
    space_robot: Tool, tmp_path: Path, arguments: tuple[str, ...], words: tuple[str, ...]
) -> None:
    """One line that names the key, exit 2, and nothing is written."""
    (tmp_path / "four.yaml").write_text(CAMPAIGN, encoding="utf-8")
    bands = CAMPAIGN.replace("duration: 8.0", "duration: 8.0, settling_bands: {}")
    (tmp_path / "bands.yaml").write_text(bands, encoding="utf-8")
    refused(space_robot("compare", *arguments), *words)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["bands.yaml", "four.yaml"]


@pytest.mark.parametrize("name", ["compare_mini", "compare_servicer"])
def test_the_shipped_comparisons_are_fair(name: str) -> None:
    """Every law meets the same periods, sensors and knowledge of the payload: nothing is varied with the law."""
    campaign = load_campaign(name)
    assert list(campaign.vary) == ["controller", "control_period", "plant.sensors", "nominal.payload_known"]
    assert campaign.runs > 1
    laws = campaign.vary["controller"]
    assert isinstance(laws, dict)
    assert {"computed_torque", "adaptive", "ntsmc", "mfac", "pd"} == set(laws)
    assert {tuple(section) for section in laws.values()} == {("law", "gains")}


def test_the_short_comparison_is_a_part_of_the_long_one() -> None:
    """Laws, settings, draws and sensors of ``compare_short`` are those of ``compare_mini``."""
    short, long = load_campaign("compare_short"), load_campaign("compare_mini")
    assert short.vary["controller"] == long.vary["controller"]
    assert (short.disperse, short.seed) == (long.disperse, long.seed)
    sensors = long.vary["plant.sensors"]
    assert isinstance(sensors, dict)
    assert read_campaign("compare_short").set == {"plant.sensors": sensors["noisy"]}
    assert short.vary["nominal.payload_known"] == long.vary["nominal.payload_known"]
    assert set(short.vary["control_period"]) <= set(long.vary["control_period"])
