"""A campaign that cannot be run is refused in one line with exit 2, and leaves nothing."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("pyarrow")
pytest.importorskip("scipy")

from space_robot_cli.main import main

CAMPAIGN = """
title: test
experiment: liu2023/fig08
set: {duration: 1.0, expect: {}}
runs: 2
"""
REFUSED: dict[str, tuple[str, tuple[str, ...]]] = {
    "an unknown key": ("dispers: {}", ("dispers", "disperse")),
    "an unknown experiment": ("experiment: liu2023/fig8", ("liu2023/fig8", "liu2023/fig08")),
    "no runs": ("runs: 0", ("runs", "0")),
    "runs without end": ("runs: 1000000000", ("1000000000", "at most")),
    "a grid without end": (
        "vary: {" + ", ".join(f"plant.sensors.{n}.noise: [0, 1, 2, 3, 4, 5, 6, 7, 8, 9]" for n in range(9)) + "}",
        ("cases", "at most"),
    ),
    "half a run": ("runs: 2.5", ("runs", "2.5")),
    "not YAML": ("disperse: {", ("line",)),
    "a key no experiment has": ("disperse: {initial.atitude_deg: {choice: [1]}}", ("atitude_deg", "attitude_deg")),
    "a key within a number": ("disperse: {duration.x: {choice: [1]}}", ("disperse.duration.x", "section")),
    "an unknown distribution": ("disperse: {duration: {gauss: {mean: 1}}}", ("gauss", "normal")),
    "two distributions": (
        "disperse: {duration: {choice: [1], uniform: {low: 1, high: 2}}}",
        ("disperse.duration", "exactly one"),
    ),
    "bounds the wrong way round": (
        "disperse: {plant.payload.mass: {uniform: {low: 2, high: 1}}}",
        ("disperse.plant.payload.mass.uniform", "low must not be above high"),
    ),
    "a negative deviation": (
        "disperse: {plant.payload.mass: {normal: {mean: 2, std: -1}}}",
        ("disperse.plant.payload.mass.normal", "negative"),
    ),
    "lists that do not fit": (
        "disperse: {initial.attitude_deg: {normal: {mean: [1, 2, 3], std: [1, 2]}}}",
        ("initial.attitude_deg", "length"),
    ),
    "nothing to choose from": ("disperse: {plant.delay_periods: {choice: []}}", ("plant.delay_periods.choice",)),
    "a NaN": ("disperse: {plant.payload.mass: {choice: [.nan]}}", ("plant.payload.mass", "finite")),
    "a value no experiment takes": ("disperse: {plant.delay_periods: {choice: [0, 7]}}", ("plant.delay_periods", "7")),
    "too few components": (
        "disperse: {initial.attitude_deg: {uniform: {low: [0, 0], high: [1, 1]}}}",
        ("initial.attitude_deg", "3"),
    ),
    "a duration off the grid": ("disperse: {duration: {uniform: {low: 1, high: 2}}}", ("duration", "nanoseconds")),
    "a mass that cannot be": (
        "disperse: {plant.payload.mass: {uniform: {low: -1, high: 1}}}",
        ("plant.payload.mass", "payload", "mass"),
    ),
    "a start outside the limits": (
        "disperse: {initial.joints_deg.3: {uniform: {low: -400, high: -200}}}",
        ("initial.joints_deg", "-180 to 180"),
    ),
    "a law there is none of": ("vary: {controller.law: [computed_torque, wizardry]}", ("wizardry", "computed_torque")),
    "nothing to vary": ("vary: {controller.law: []}", ("vary.controller.law",)),
    "varied and dispersed": (
        "vary: {seed: [1, 2]}\ndisperse: {seed: {choice: [1]}}",
        ("seed", "both varied and dispersed"),
    ),
    "a seed twice": ("runs: 2\nseeds: [3, 3]", ("seed", "twice")),
    "fewer seeds than runs": ("runs: 2\nseeds: [3]", ("2 runs, but 1 seeds",)),
    "seeds listed and varied": ("seeds: [3, 4]\nvary: {seed: [1, 2]}", ("seed", "varied or dispersed")),
    "an unknown number": ("expect: {sucess_rate: {min: 1}}", ("expect.sucess_rate", "success_rate")),
    "an unknown statistic": ("expect: {base/roll.overshoot.avg: {max: 1}}", ("base/roll.overshoot",)),
    "a set that fits nothing": ("set: {contol_period: 1}", ("contol_period", "control_period")),
}

Tool = Callable[..., tuple[int, str]]


@pytest.fixture
def space_robot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Tool:
    """Calls the tool in an empty folder; returns its exit code and stderr."""

    def call(*arguments: str) -> tuple[int, str]:
        monkeypatch.chdir(tmp_path)
        monkeypatch.setattr(sys, "argv", ["space-robot", *arguments])
        with pytest.raises(SystemExit) as end:
            main()
        assert isinstance(end.value.code, int)
        return end.value.code, capsys.readouterr().err

    return call


def refused(done: tuple[int, str], *words: str) -> None:
    code, said = done
    assert code == 2
    lines = [line for line in said.splitlines() if line.strip()]
    assert len(lines) == 1, said
    for word in words:
        assert word in lines[0], lines[0]


def write(folder: Path, change: str = "") -> None:
    """The campaign with the sections of ``change`` in place of its own."""
    names = {line.split(":")[0] for line in change.splitlines()}
    kept = [line for line in CAMPAIGN.splitlines() if line.split(":")[0] not in names]
    (folder / "campaign.yaml").write_text("\n".join([*kept, change, ""]), encoding="utf-8")


@pytest.mark.parametrize(("change", "words"), list(REFUSED.values()), ids=list(REFUSED))
def test_a_campaign_that_cannot_run_is_refused(
    space_robot: Tool, tmp_path: Path, change: str, words: tuple[str, ...]
) -> None:
    """Each mistake is named with its key and what would do, before any worker starts or anything is written."""
    write(tmp_path, change)
    refused(space_robot("campaign", "campaign.yaml", "--out", "out"), *words)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["campaign.yaml"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("nowhere.yaml",), ("nowhere.yaml", "fig08_dispersed")),
        (("campaign.yaml", "--runs", "0"), ("runs", "0")),
        (("campaign.yaml", "--workers", "0"), ("--workers", "0")),
        (("campaign.yaml", "--keep", "some"), ("--keep", "some", "failed")),
        (("campaign.yaml", "--workers", "2", "--scheduler", "tcp://127.0.0.1:9"), ("--scheduler", "--workers")),
        (("campaign.yaml", "--workers", "1025"), ("--workers", "1025", "1 to 1024")),
        (("campaign.yaml", "--time-limit", "0"), ("--time-limit", "0", "[s]")),
        (("campaign.yaml", "--time-limit", "nan"), ("--time-limit", "nan", "[s]")),
        (("campaign.yaml", "--out", "campaign.yaml"), ("--out", "file")),
        (("campaign.yaml", "--out", "x" * 5000), ("xxx", "too long")),
        (("campaign.yaml", "--out", "a\0b"), ("null byte",)),
        (("campaign.yaml", "--out", "precious"), ("--out", "precious", "empty")),
        (("campaign.yaml", "--out", "precious", "--resume"), ("--out", "precious", "empty")),
    ],
    ids=lambda value: " ".join(value[1:])[:40].replace("\0", "") or "no such file",
)
def test_an_option_that_cannot_be_used(
    space_robot: Tool, tmp_path: Path, arguments: tuple[str, ...], words: tuple[str, ...]
) -> None:
    """An option is refused like a file; also a directory with something in it."""
    write(tmp_path)
    (tmp_path / "precious").mkdir()
    (tmp_path / "precious" / "thesis.tex").write_text("years")
    out = () if "--out" in arguments else ("--out", "out")
    refused(space_robot("campaign", *arguments, *out), *words)
    assert sorted(path.name for path in tmp_path.rglob("*")) == ["campaign.yaml", "precious", "thesis.tex"]


@pytest.mark.parametrize(("address", "word"), [("nonsense", "nonsense"), ("tcp://127.0.0.1:9", "reached")])
def test_a_scheduler_that_is_not_there(
    space_robot: Tool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, address: str, word: str
) -> None:
    """An address at which nothing answers is refused, and nothing is written."""
    pytest.importorskip("distributed")
    from space_robot_studies.engine import dask_workers

    monkeypatch.setattr(dask_workers, "CONNECT_SECONDS", 0.5)
    write(tmp_path)
    refused(space_robot("campaign", "campaign.yaml", "--scheduler", address, "--out", "out"), "--scheduler", word)
    assert sorted(path.name for path in tmp_path.rglob("*")) == ["campaign.yaml"]


def test_without_dask_a_scheduler_is_refused(
    space_robot: Tool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Only `--scheduler` needs Dask, and says what to install."""
    monkeypatch.setitem(sys.modules, "distributed", None)
    monkeypatch.delitem(sys.modules, "space_robot_studies.engine.dask_workers", raising=False)
    write(tmp_path)
    done = space_robot("campaign", "campaign.yaml", "--scheduler", "tcp://127.0.0.1:9", "--out", "out")
    refused(done, "--scheduler", "Dask", "space-robot[cluster]")


@pytest.mark.parametrize(
    "arguments",
    [
        ("--from", "out"),
        ("--index", "3"),
        ("liu2023/fig08", "--from", "out", "--index", "3"),
        ("--from", "out", "--index", "3", "--set", "seed=1"),
        (),
    ],
    ids=" ".join,
)
def test_run_needs_either_an_experiment_or_a_case(
    space_robot: Tool, tmp_path: Path, arguments: tuple[str, ...]
) -> None:
    """A run is an experiment, or a directory with an index."""
    refused(space_robot("run", *arguments), "run", "EXPERIMENT or --from DIR --index K")


def test_a_directory_of_another_campaign_is_left_alone(space_robot: Tool, tmp_path: Path) -> None:
    """Resumed are only the campaign, the number of runs and the versions a directory was begun with."""
    from space_robot_bringup.compose.versions import versions
    from space_robot_studies.campaign.directory import open_campaign
    from space_robot_studies.campaign.spec import load_campaign

    write(tmp_path)
    here = {name: versions()[name] for name in versions()}
    with open_campaign(tmp_path / "out", load_campaign(tmp_path / "campaign.yaml"), here, 9.0):
        refused(space_robot("run", "--from", "out", "--index", "2"), "--index", "0 to 1")
        refused(space_robot("run", "--from", ".", "--index", "2"), "no campaign")
    before = {path: path.read_bytes() for path in (tmp_path / "out").iterdir()}
    refused(space_robot("campaign", "campaign.yaml", "--out", "out"), "--out", "--resume")
    write(tmp_path, "disperse: {plant.delay_periods: {choice: [0, 1]}}")
    refused(space_robot("campaign", "campaign.yaml", "--out", "out", "--resume"), "another campaign", "disperse")
    assert {path: path.read_bytes() for path in (tmp_path / "out").iterdir()} == before


def columns(index: int, *, passed: bool) -> dict[str, Any]:
    """What every row has."""
    outcome = {"end_reason": "completed", "completed": True, "passed": passed, "failed": "", "ticks": 5}
    return {"index": index, "run": index, "seed": 7, **outcome}


def test_rows_of_other_versions_are_not_gone_on_with(tmp_path: Path) -> None:
    """Rows are comparable only if everything that can change their bits is the same; a torn line is cut off."""
    from space_robot_msgs_py.errors import LogError, SpecError
    from space_robot_studies.campaign.directory import open_campaign
    from space_robot_studies.campaign.spec import load_campaign
    from space_robot_studies.engine.journal import Row, finished_row

    write(tmp_path)
    spec, out = load_campaign(str(tmp_path / "campaign.yaml")), tmp_path / "out"
    with open_campaign(out, spec, {"pin": "1"}, 9.0) as book:
        book.append(Row(0, columns(0, passed=True)), {"a.mcap": b"bag"})
        book.append(Row(1, columns(1, passed=False), lost=True), {})
        with pytest.raises(SpecError, match="another process"), open_campaign(out, spec, {"pin": "1"}, 9.0):
            pass
    with pytest.raises(SpecError, match="begun with pin 1"), open_campaign(out, spec, {"pin": "2"}, 9.0):
        pass
    rows = (out / "rows.jsonl").read_text()
    (out / "rows.jsonl").write_text(rows + json.dumps({"key": 1, "columns": {}})[:-1])
    found = finished_row(out, 1)
    assert found is not None
    assert found.lost
    with open_campaign(out, spec, {"pin": "1"}, 9.0) as book:
        assert book.rows.keys() == {0}
    assert (out / "rows.jsonl").read_text() == rows
    (out / "rows.jsonl").write_text(rows.replace('"ticks": 5', '"ticks": "5"'))
    with pytest.raises(LogError, match=r"line 2 is corrupted .*ticks"), open_campaign(out, spec, {"pin": "1"}, 9.0):
        pass
    (out / "rows.jsonl").write_text(rows.replace("key", "kay"))
    with pytest.raises(LogError, match="line 2 is corrupted"), open_campaign(out, spec, {"pin": "1"}, 9.0):
        pass
    assert (out / "runs" / "000000" / "a.mcap").read_bytes() == b"bag"
