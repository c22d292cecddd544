"""Every mistake of a manifest or of an option is one line before the first run."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import pytest

from tests.support.manifests import write
from tests.support.tool import Tool, refused

pytest.importorskip("matplotlib")
pytest.importorskip("jinja2")

ONE = {"metric": "base/roll.final_error", "of": "real"}
CLAIM: dict[str, Any] = {
    "paper": "p",
    "measures": {"a": ONE},
    "holds_if": "a < 1",
    "found": "{a}",
    "expect": "holds",
}
BAD: dict[str, tuple[dict[str, Any], tuple[str, ...]]] = {
    "an unknown key": ({"pannels": []}, ("figures.8.pannels", "panels")),
    "an unknown group": ({"panels": [{"signals": ["base.error"], "of": ["reel"]}]}, ("panels.0.of", "reel", "real")),
    "an unknown signal": ({"panels": [{"signals": ["base/rol.error"]}]}, ("panels.0.signals.0", "base/roll.error")),
    "an unknown color": (
        {"panels": [{"signals": ["base.error"], "style": {"real": "rde"}}]},
        ("panels.0.style.real", "rde"),
    ),
    "style of nothing": (
        {"panels": [{"signals": ["base.error"], "style": {"reel": "red"}}]},
        ("panels.0.style", "reel", "real"),
    ),
    "empty limits": ({"panels": [{"signals": ["base.error"], "limits": [1, 1]}]}, ("panels.0.limits",)),
    "no place on a log scale": (
        {"panels": [{"signals": ["base.error"], "limits": [0, 1], "y_scale": "log"}]},
        ("panels.0.limits", "above 0"),
    ),
    "a window the wrong way": (
        {"panels": [{"signals": ["base.error"], "after": 3, "before": 2}]},
        ("panels.0.before", "> 3"),
    ),
    "an unknown metric": (
        {"tables": [{"columns": {"x": {"metric": "base/roll.setling_time", "reduce": "max"}}}]},
        ("tables.0.columns.x.metric", "base/roll.settling_time"),
    ),
    "many runs and no reduce": (
        {"tables": [{"columns": {"x": {"metric": "base/roll.max_error"}}}]},
        ("tables.0.columns.x", "2 runs and no reduce"),
    ),
    "an unknown abscissa": (
        {"charts": [{"measure": {"metric": "completed"}, "x": "controller.gains.lambd"}]},
        ("charts.0.x", "controller.gains.lambd"),
    ),
    "a take without a signal": (
        {"claims": [CLAIM | {"measures": {"a": {"metric": "completed", "take": "max", "of": "real"}}}]},
        ("claims.0.measures.a", "signal and take"),
    ),
    "a window behind the end": (
        {"claims": [CLAIM | {"measures": {"a": {"signal": "base.error", "take": "max", "after": 7, "of": "real"}}}]},
        ("claims.0.measures.a.after", "6 s"),
    ),
    "where nothing is": ({"claims": [CLAIM | {"measures": {"a": ONE | {"where": {"seed": 9}}}}]}, ("a.where", "9")),
    "a time of nothing": (
        {"claims": [CLAIM | {"measures": {"a": {"timing": "mean", "of": "real"}}}]},
        ("claims.0.measures.a.timing", "timing table"),
    ),
    "a name that is a word": ({"claims": [CLAIM | {"measures": {"lambda": ONE}}]}, ("claims.0.measures", "lambda")),
    "a name that is none": ({"claims": [CLAIM | {"measures": {"a b": ONE}}]}, ("claims.0.measures", "a b")),
    "a condition of unknowns": ({"claims": [CLAIM | {"holds_if": "b < 1"}]}, ("claims.0.holds_if", "'b'")),
    "a text of unknowns": ({"claims": [CLAIM | {"found": "{b}"}]}, ("claims.0.found", "'b'")),
    "an unknown verdict": ({"claims": [CLAIM | {"expect": "hold"}]}, ("claims.0.expect", "holds")),
    "no reason": ({"claims": [{"paper": "p", "expect": "not checkable"}]}, ("claims.0", "because")),
    "a run that cannot be composed": (
        {"runs": {"real": {"experiment": "liu2023/fig08", "set": {"controller.gains.lambda": -1}}}},
        ("figures.8.runs.real", "real cannot be run", "lambda"),
    ),
    "two runs of one label": (
        {"runs": {"a": {"experiment": "liu2023/fig08", "seeds": [1, 2]}, "a 1": {"experiment": "liu2023/fig08"}}},
        ("figures.8.runs", "a 1"),
    ),
    "a timed crowd": ({"timing": {"of": ["prior"]}}, ("timing.of", "more than one run")),
}


@pytest.mark.parametrize(("changes", "words"), list(BAD.values()), ids=list(BAD))
def test_a_bad_manifest_gets_one_line_and_leaves_nothing(
    space_robot: Tool, tmp_path: Path, changes: dict[str, Any], words: tuple[str, ...]
) -> None:
    """Every mistake is found before the first run: key path, value and what would do, exit 2, nothing written."""
    emptied: dict[str, Any] = {"panels": [], "tables": [], "claims": []}
    write(tmp_path, **(emptied | changes))
    before = set(tmp_path.rglob("*"))
    refused(space_robot("reproduce", "paper.yaml", "--figure", "8"), *words)
    assert set(tmp_path.rglob("*")) == before


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("papr.yaml",), ("paper", "papr.yaml")),
        (("paper.yaml", "--figure", "gian"), ("--figure", "gian", "gain")),
        (("paper.yaml", "--workers", "0"), ("--workers", "0")),
        (("paper.yaml", "--time-limit", "-1"), ("--time-limit", "-1")),
        (("paper.yaml", "--out", "precious"), ("--out", "precious")),
        (("paper.yaml", "--out", "paper.yaml"), ("--out", "paper.yaml")),
        (("paper.yaml", "--markdown", "no/where.md"), ("--markdown", "no/where.md")),
    ],
)
def test_bad_options_get_one_line_and_leave_nothing(
    space_robot: Tool, tmp_path: Path, arguments: tuple[str, ...], words: tuple[str, ...]
) -> None:
    """Unknown papers and figures suggest the nearest; a folder of something else is not touched."""
    write(tmp_path)
    (tmp_path / "precious").mkdir()
    (tmp_path / "precious" / "index.html").write_text("years")
    before = set(tmp_path.rglob("*"))
    refused(space_robot("reproduce", *arguments), *words)
    assert set(tmp_path.rglob("*")) == before


def test_without_the_drawing_libraries_it_says_what_to_install(
    space_robot: Tool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without matplotlib or jinja2 nothing is run and the extra is named."""
    write(tmp_path)
    monkeypatch.setitem(sys.modules, "jinja2", None)
    for name in ("html", "paper_report"):
        monkeypatch.delitem(sys.modules, f"space_robot_report.pages.{name}", raising=False)
    refused(space_robot("reproduce", "paper.yaml"), "jinja2", "space-robot[viz]")
    assert not (tmp_path / "out").exists()


def test_a_campaigns_directory_is_left_alone(space_robot: Tool, tmp_path: Path) -> None:
    """A reproduction goes into no directory of a campaign, whose rows it would replace."""
    write(tmp_path)
    (tmp_path / "mc" / "runs").mkdir(parents=True)
    for name in ("resolved.yaml", "rows.jsonl"):
        (tmp_path / "mc" / name).write_text("years")
    refused(space_robot("reproduce", "paper.yaml", "--out", "mc"), "--out", "holds a campaign")
    assert (tmp_path / "mc" / "rows.jsonl").read_text() == "years"
