"""One word, one meaning: words that CONTRIBUTING's table replaces do not come back."""

from __future__ import annotations

import re
from collections.abc import Iterator

import pytest

from tests.docs.pages import ROOT
from tests.docs.tree import files_of

# As in identifiers, so in prose: an underscore or a capital begins a word.
REPLACED = {
    "run": r"fl(?:y|ies|ew|own)|flights?",
    "no process, a third party, another tool": r"nobody|somebody|anybody|whoever",
    "given, called with, notified, ordered": r"told",
    "compared with": r"held against",
    "shipped, of the project, custom": r"of (?:ours|yours)",
    "MAX_, MIN_": r"(?-i:(?:MOST|LARGEST|LONGEST|LEAST|SMALLEST|SHORTEST|FEWEST)(?=_[A-Z]))",
}
OLD = re.compile(
    rf"(?<![a-z])(?:{'|'.join(f'({old})' for old in REPLACED.values())})(?![a-z])|(?-i:[a-z](Flights?|Flown))", re.I
)
# Terms of the field; in a comment a line may end within one.
ALLOWED = re.compile(r"free[- ]fly(?:er|ing)|flight[\s#_]+software|flight-like|on the fly", re.I)
TEXT = (".py", ".md", ".j2", ".yaml", ".js", ".css", "Makefile")
# Titles are part of recorded logs, numbers in golden ones.
TITLE = re.compile(r"^title: .*$", re.M)
# Places that still have some: see the last test.
EXEMPT: tuple[str, ...] = ()


def old_words(text: str) -> Iterator[tuple[int, str, str]]:
    """(line, word, what to write) of every replaced word in a text."""
    plain = ALLOWED.sub(lambda term: re.sub(r"[^\n]", " ", term.group()), text)
    for found in OLD.finditer(plain):
        kind = next((index for index, group in enumerate(found.groups()) if group is not None), 0)
        better = [*REPLACED, "run"][kind]
        yield text.count("\n", 0, found.start()) + 1, found.group(), better


def found_in(name: str) -> list[str]:
    """What is to be replaced in a file, a line each."""
    text = (ROOT / name).read_text(encoding="utf-8")
    if name.startswith("config/"):
        text = TITLE.sub("", text)
    return [f"{name}:{line}: {word!r}, write {better}" for line, word, better in old_words(text)]


FILES = sorted(name for name in files_of(ROOT) if name.endswith(TEXT) and name != "tests/docs/test_words.py")


def test_replaced_words_do_not_come_back() -> None:
    """No identifier, docstring, comment, text or page has a word of the table of replaced ones."""
    assert len(FILES) > 500
    found = [line for name in FILES if not name.startswith(EXEMPT) for line in found_in(name)]
    assert not found, "\n".join(found)


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("def fly_graph(x):", "fly"),
        ("_flown = 1", "flown"),
        ("class TestFlight:", "tFlight"),
        ("MOST_BYTES = 3", "MOST"),
        ("_LONGEST_STEP = 3", "LONGEST"),
        ("# Nobody reads it.", "Nobody"),
        ("gains that change in flight", "flight"),
        ("flight\nrecorder", "flight"),
    ],
)
def test_a_replaced_word_is_found(text: str, word: str) -> None:
    """In a name, a class, a constant, a comment and prose, however it is written."""
    assert [found for _, found, _ in old_words(text)] == [word]


@pytest.mark.parametrize(
    "text", ["flight\n# software", "a free-flying base", "JointModelFreeFlyer", "butterfly", "at most", "MOST of it"]
)
def test_a_term_of_the_field_passes(text: str) -> None:
    """Flight software and free flyers keep their names, and parts of other words are no words."""
    assert not list(old_words(text))


@pytest.mark.parametrize("place", EXEMPT)
def test_no_exemption_outlives_its_reason(place: str) -> None:
    """A place is exempt only while it has a replaced word."""
    assert any(found_in(name) for name in FILES if name.startswith(place))
