"""Verdicts as JUnit XML, which servers of continuous integration read: a test case per expectation, case or comparison.

What fails is a failure, what is not judged is skipped, what could not be done is an error. The shape is the one that
Jenkins and GitLab share: suites of test cases with at most one outcome each, requirements named in the names.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal
from xml.etree import ElementTree as ET

from space_robot_bringup.judge.check import Check
from space_robot_msgs_py.atomic_file import write_atomically
from space_robot_msgs_py.bounded_files import is_directory, short
from space_robot_msgs_py.errors import InputFileError
from space_robot_msgs_py.escapes import visible

Kind = Literal["failure", "error", "skipped"]
# What remains forbidden in XML after controls are shown as their codes.
_NO_CHARACTERS = re.compile("[\ufffe\uffff]")


@dataclass(frozen=True, slots=True)
class Case:
    """One test case.

    Attributes:
        name: what was tested.
        kind: None: it passed.
        message: of the outcome, in one line.
        detail: more of it.
        seconds: it took [s]; None: not known by itself.
    """

    name: str
    kind: Kind | None = None
    message: str = ""
    detail: str = ""
    seconds: float | None = None


@dataclass(frozen=True, slots=True)
class Suite:
    """Test cases that belong together.

    Attributes:
        name: of the run, campaign or bag.
        cases: in order.
        properties: what else is known, by name.
        seconds: it took [s]; None: the sum of its cases.
        said: further lines.
    """

    name: str
    cases: Sequence[Case]
    properties: Mapping[str, str]
    seconds: float | None = None
    said: Sequence[str] = ()

    @property
    def time(self) -> float:
        """It took [s]."""
        return sum(case.seconds or 0.0 for case in self.cases) if self.seconds is None else self.seconds

    def count(self, kind: Kind) -> int:
        """How many of its cases ended so."""
        return sum(case.kind == kind for case in self.cases)


def check_junit(path: Path | None) -> None:
    """Refuse a file that could not be written at the end.

    Raises:
        InputFileError: there is no such folder, or it is a folder itself.
    """
    if path is None:
        return
    if not is_directory(path.resolve().parent):
        raise InputFileError("no such folder", key="--junit", value=short(path))
    if is_directory(path):
        raise InputFileError("is a directory", key="--junit", value=short(path), accepted="the name of a file")


def write_junit(path: Path | None, suites: Iterable[Suite]) -> None:
    """Write suites into a file, where there is one to write.

    Raises:
        LogError: it cannot be written.
    """
    if path is not None:
        write_atomically(path, junit(tuple(suites)))


def junit(suites: Sequence[Suite]) -> str:
    """The document; well-formed whatever the texts are."""
    root = ET.Element("testsuites", _totals(suites))
    for suite in suites:
        one = ET.SubElement(root, "testsuite", {"name": _text(suite.name)} | _totals([suite]))
        one.set("skipped", str(suite.count("skipped")))
        properties = ET.SubElement(one, "properties")
        for name, value in suite.properties.items():
            ET.SubElement(properties, "property", {"name": _text(name), "value": _text(value)})
        for case in suite.cases:
            _add(one, case, suite.name)
        if suite.said:
            ET.SubElement(one, "system-out").text = _text("\n".join(suite.said))
    ET.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(root, encoding="unicode") + "\n"


def check_cases(checks: Iterable[Check], end_reason: str) -> Iterator[Case]:
    """One test case per check; that a run did not end by itself is an error."""
    for check in checks:
        requirement = f" ({check.requirement})" if check.requirement else ""
        # Names of what every run is held to say nothing of this run, so that servers follow them over runs.
        wanted = "" if check.about == "run" else f": {check.wanted}"
        name = f"{check.name}{requirement}{wanted}"
        if check.passed:
            yield Case(name)
        elif not check.judged:
            yield Case(name, "skipped", f"not judged: {check.reason}")
        elif check.name == "completed" and end_reason != "completed":
            yield Case(name, "error", end_reason)
        else:
            yield Case(name, "failure", check.line)


def _totals(suites: Sequence[Suite]) -> dict[str, str]:
    return {
        "tests": str(sum(len(suite.cases) for suite in suites)),
        "failures": str(sum(suite.count("failure") for suite in suites)),
        "errors": str(sum(suite.count("error") for suite in suites)),
        "time": f"{sum(suite.time for suite in suites):.3f}",
    }


def _add(suite: ET.Element, case: Case, group: str) -> None:
    one = ET.SubElement(suite, "testcase", {"name": _text(case.name), "classname": _text(group)})
    one.set("time", f"{case.seconds or 0.0:.3f}")
    if case.kind is not None:
        outcome = ET.SubElement(one, case.kind, {"message": _text(case.message)})
        outcome.text = _text(case.detail or case.message)


def _text(text: str) -> str:
    return _NO_CHARACTERS.sub("", visible(text))
