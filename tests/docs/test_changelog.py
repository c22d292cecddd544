"""The changelog can be read by component, and by tools that know its format."""

from __future__ import annotations

import re
import tomllib

from tests.docs.pages import ROOT

TEXT = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
# Keep a Changelog's.
KINDS = {"Added", "Changed", "Deprecated", "Removed", "Fixed", "Security"}


def components() -> set[str]:
    """What a bullet may start with, as CONTRIBUTING lists it."""
    page = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    (sentence,) = re.findall(r"start with a component: (.*?)\.\s", page, re.DOTALL)
    return set(re.findall(r"`(\w+):`", sentence))


def test_every_bullet_starts_with_its_component() -> None:
    """Each change names one of the listed components first."""
    bullets = re.findall(r"^- (.*)$", TEXT, re.MULTILINE)
    assert bullets
    assert len(components()) > 5
    wrong = [bullet for bullet in bullets if bullet.partition(": ")[0] not in components()]
    assert not wrong, f"accepted: {', '.join(sorted(components()))}; got\n" + "\n".join(wrong)


def test_sections_are_those_of_the_format() -> None:
    """Versions are SemVer with a date, the unreleased one first; under each only the kinds of Keep a Changelog."""
    first, *versions = re.findall(r"^## (.*)$", TEXT, re.MULTILINE)
    assert first == "Unreleased"
    assert all(re.fullmatch(r"\[?\d+\.\d+\.\d+\]? - \d{4}-\d\d-\d\d", version) for version in versions)
    assert set(re.findall(r"^### (.*)$", TEXT, re.MULTILINE)) <= KINDS


def test_the_newest_version_is_that_of_the_package() -> None:
    """A version that is cut has its section, and the date of the citation."""
    (_, version, date), *_ = re.findall(r"^## (\[?)(\d+\.\d+\.\d+)\]? - (\S+)$", TEXT, re.MULTILINE)
    package = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert package["project"]["version"] == version
    assert f'\nversion: {version}\ndate-released: "{date}"\n' in citation
