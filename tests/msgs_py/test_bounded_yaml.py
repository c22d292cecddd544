"""YAML 1.2 as the reader in C takes it, beside another reader."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from ruamel.yaml import YAML

from space_robot_msgs_py.bounded_yaml import load_yaml
from space_robot_msgs_py.errors import SpecError
from tests.support.paths import ROOT

FILES = sorted(path for folder in ("config", "examples") for path in (ROOT / folder).rglob("*.yaml"))
SCALARS = {
    "": None, "~": None, "null": None, "nULL": "nULL", "true": True, "FALSE": False, "yes": "yes", "on": "on", "y": "y",
    "1": 1, "-1": -1, "+1": 1, "010": 10, "0o17": 15, "0x1F": 31, "0b101": 5, "-0x10": -16, "1_000": 1000, "_1": "_1",
    "1.": 1.0, ".5": 0.5, "-.5e-3": -0.0005, "1e3": 1000.0, "1.5E+2": 150.0, "1e": "1e", "e3": "e3", "1:30": "1:30",
    "1.2.3": "1.2.3", "-": None, ".": ".", "..": "..", "+": "+", "1 2": "1 2", "'1'": "1", '"~"': "~", "!!str 1": "1",
    "!!float 1": 1.0, "x#y": "x#y", "a/b:c": "a/b:c", "{a: 1, b}": {"a": 1, "b": None}, "[a, b: c]": None,
}  # fmt: skip


@pytest.mark.parametrize("text", SCALARS)
def test_scalars_are_those_of_yaml_1_2(text: str) -> None:
    """Numbers in all their forms, and words that only YAML 1.1 takes for truth values, dates of day and hours."""
    if text in ("-", "[a, b: c]"):
        expected: Any = [None] if text == "-" else ["a", {"b": "c"}]
    else:
        expected = SCALARS[text]
    found = load_yaml(f"k:\n  {text}", "test")["k"]
    assert found == expected
    assert type(found) is type(expected)


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_every_shipped_file_is_read_as_another_reader_does(path: Path) -> None:
    """Values, types and the order of keys."""
    text = path.read_text()
    assert repr(load_yaml(text, "test")) == repr(YAML(typ="safe", pure=True).load(text))


PLACES = {
    "a: 1\nb: [1, 2\nc: 3\n": "line 3",
    "a: 1\n\tb: 2\n": "line 2, column 1",
    "a: 1\nb: x\x07y\n": "line 2, column 5",
    "a: 1\nb: !!int x\n": "line 2, column 4",
    "a: 1\nb: !!bool maybe\n": "line 2, column 4",
    "a: 1\nb: *c\n": "line 2, column 4",
    "a: &x 1\nb: &x 2\n": "line 2, column 4: found duplicate anchor",
    "a: 1\nb: {<<: 1}\n": "line 2, column 9: only mappings are merged",
    "a: 1\n--- 2\n": "line 2, column 1",
}


@pytest.mark.parametrize("text", PLACES)
def test_what_is_wrong_is_said_with_its_place(text: str) -> None:
    """One line with line and column, as an editor counts them."""
    with pytest.raises(SpecError) as refusal:
        load_yaml(text, "test")
    assert PLACES[text] in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_of_merged_mappings_the_first_counts_and_what_stands_beside_them_most() -> None:
    """And what is named twice is one object, made once."""
    text = "a: &a {x: 1, y: 1}\nb: &b {x: 2, z: 2}\nc: {z: 3, <<: [*a, *b]}\nd: *a\n"
    data = load_yaml(text, "test")
    assert data["c"] == {"x": 1, "y": 1, "z": 3}
    assert data["d"] is data["a"]


def test_the_empty_text_is_nothing() -> None:
    """So is one of comments only."""
    assert load_yaml("", "test") is None
    assert load_yaml("# nothing\n", "test") is None
