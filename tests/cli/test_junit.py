"""JUnit XML of runs, campaigns and replays: what Jenkins and GitLab read, well-formed whatever the texts are."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import pytest

from space_robot_bringup.judge.check import Check
from space_robot_cli.junit import Case, Suite, check_cases, junit
from space_robot_cli.main import main

# The schema that Jenkins checks results by, and which GitLab reads a part of: children in any order, attributes.
TOTALS = {"name", "tests", "failures", "errors", "time"}
OUTCOME = (set[str](), {"message", "type"})
SHAPE: dict[str, tuple[set[str], set[str]]] = {
    "testsuites": ({"testsuite"}, TOTALS),
    "testsuite": ({"properties", "testcase", "system-out"}, TOTALS | {"skipped"}),
    "properties": ({"property"}, set()),
    "property": (set(), {"name", "value"}),
    "testcase": ({"failure", "error", "skipped"}, {"name", "classname", "time"}),
    "failure": OUTCOME,
    "error": OUTCOME,
    "skipped": OUTCOME,
    "system-out": (set(), set()),
}
REQUIRED = {"testsuite": {"name", "tests", "failures", "errors"}, "testcase": {"name"}, "property": {"name", "value"}}
HOSTILE = 'a"b<c>&\x00\x1b[2J\x85\ud800\ufffe\uffff]]>\u202e\n\té'


def checked(text: str) -> ET.Element:
    """The document, which has the shape, and counts what is in it."""
    root = ET.fromstring(text)
    assert root.tag == "testsuites"
    for one in root.iter():
        children, attributes = SHAPE[one.tag]
        assert {child.tag for child in one} <= children
        assert REQUIRED.get(one.tag, set()) <= one.attrib.keys() <= attributes
    for group in (root, *root.iter("testsuite")):
        for name, tag in (("tests", "testcase"), ("failures", "failure"), ("errors", "error")):
            assert int(group.attrib[name]) == len(list(group.iter(tag)))
    assert all(len(case) <= 1 for case in root.iter("testcase"))
    return root


def tool(monkeypatch: pytest.MonkeyPatch, *arguments: object) -> int:
    """The exit code of a command in this process."""
    monkeypatch.setattr(sys, "argv", ["space-robot", *map(str, arguments)])
    with pytest.raises(SystemExit) as exit_:
        main()
    return int(str(exit_.value.code))


def test_any_text_makes_a_document() -> None:
    """Controls, halves of characters, markup and what XML forbids stand nowhere as themselves; the rest is kept."""
    case = Case(HOSTILE, "failure", HOSTILE, HOSTILE)
    suite = Suite(HOSTILE, [case, Case("fine")], {HOSTILE: HOSTILE}, said=[HOSTILE])
    root = checked(junit([suite, Suite("empty", (), {})]))
    text = root.find("testsuite/testcase/failure").text  # type: ignore[union-attr]
    assert text == 'a"b<c>&\\x00\\x1b[2J\\x85\\ud800]]>\\u202e\n\té'


@pytest.mark.parametrize(
    ("check", "end", "kind", "words"),
    [
        (Check("base.rate", 0.1, "never above 1 rad/s", True, "REQ-1"), "completed", None, ""),
        (
            Check("base.rate", 2.0, "never above 1 rad/s", False, "REQ-1", "2 rad/s at 1 s"),
            "completed",
            "failure",
            "2 rad",
        ),
        (
            Check("mode.SAFE", None, "within 5 s", False, "", "too soon", judged=False),
            "completed",
            "skipped",
            "too soon",
        ),
        (Check("completed", None, "the run ends by itself", False), "controller: no", "error", "controller: no"),
    ],
)
def test_a_check_is_a_test_case(check: Check, end: str, kind: str | None, words: str) -> None:
    """A failure, skipped where it is not judged, an error of the end, with the reason; the requirement in its name."""
    (case,) = check_cases([check], end)
    assert (case.kind, words in case.message) == (kind, True)
    requirement = f" ({check.requirement})" if check.requirement else ""
    assert case.name == f"{check.name}{requirement}"


EXPECT: dict[str, Any] = {
    "base.rate": [{"never_above": 100.0, "id": "REQ-1"}, {"never_above": 1e-9, "id": "REQ-2"}],
    "mode": {"SAFE": {"within": 9.0, "id": "REQ-3"}},
}


def test_run_and_replay_write_what_they_print(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A test case per check, as ``--json``, which has requirement and reason, says it; one per side replayed."""
    place, xml, settings = tmp_path / "run", tmp_path / "run.xml", {"expect": EXPECT, "supervision": "mini_basic"}
    changes = [text for key, value in settings.items() for text in ("--set", f"{key}={json.dumps(value)}")]
    assert (
        tool(monkeypatch, "run", "liu2023/fig08", "--duration", 3, *changes, "--out", place, "--junit", xml, "--json")
        == 1
    )
    said = json.loads(capsys.readouterr().out)
    (suite,) = checked(xml.read_text(encoding="utf-8")).iter("testsuite")
    assert (suite.attrib["name"], suite.attrib["failures"], suite.attrib["skipped"]) == ("liu2023/fig08", "1", "1")
    assert len(list(suite.iter("testcase"))) == len(said["checks"])
    assert said["verdict"] == "FAIL"
    found = {check["requirement"]: check for check in said["checks"] if check["requirement"]}
    assert [one["passed"] for one in found.values()] == [True, False, False]
    assert "too soon after 0 s" in found["REQ-3"]["reason"]
    assert found["REQ-3"]["judged"] is False
    assert tool(monkeypatch, "replay", place, "--junit", xml) == 0
    assert [case.attrib["name"] for case in checked(xml.read_text()).iter("testcase")] == [
        "controller",
        "plant",
        "supervisor",
    ]
    assert (
        tool(
            monkeypatch,
            "replay",
            place,
            "--against",
            "controller",
            "--set",
            "controller.gains.kappa=0.1",
            "--junit",
            xml,
        )
        == 1
    )
    (failure,) = checked(xml.read_text()).iter("failure")
    assert failure.attrib["message"].startswith("first different: base/")


def test_a_campaign_is_a_suite_per_point(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A test case per run, those of which nothing was expected skipped, and the verdict on all of them."""
    pytest.importorskip("pyarrow")
    text = """
title: "two < laws"
experiment: liu2023/fig08
set: {duration: 1.0, expect: {}, controller.gains: {}}
runs: 2
vary: {controller.law: [computed_torque, "tests.support.laws:GivesUp"]}
"""
    (tmp_path / "two.yaml").write_text(text)
    xml = tmp_path / "campaign.xml"
    arguments = ("--workers", 1, "--out", tmp_path / "out", "--junit", xml, "--keep", "none")
    assert tool(monkeypatch, "campaign", tmp_path / "two.yaml", *arguments) == 1
    fine, bad, verdict = checked(xml.read_text(encoding="utf-8")).iter("testsuite")
    assert [fine.attrib[name] for name in ("tests", "failures", "errors", "skipped")] == ["2", "0", "0", "2"]
    assert [bad.attrib[name] for name in ("tests", "failures", "errors", "skipped")] == ["2", "0", "2", "0"]
    assert (verdict.attrib["name"], verdict.attrib["failures"]) == ("two: verdict", "1")


@pytest.mark.parametrize("place", ["nowhere/run.xml", "."])
def test_a_file_that_cannot_be_written_is_refused_before_the_run(
    place: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """One line, exit 2, nothing run."""
    monkeypatch.chdir(tmp_path)
    assert tool(monkeypatch, "run", "liu2023/fig08", "--junit", place) == 2
    assert "--junit" in capsys.readouterr().err
    assert not (tmp_path / "runs").exists()
