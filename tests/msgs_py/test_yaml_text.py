"""YAML that machines write is read back as it was, by readers of YAML 1.2, too."""

from __future__ import annotations

import pytest

from space_robot_msgs_py.bounded_yaml import load_yaml
from space_robot_msgs_py.yaml_text import yaml_text

TEXTS = (
    "", " ", "plain", "yes", "on", "null", "~", "1", "1e3", "-.5e-3", "1.", ".5", "0o14", "0x1F", "1_000", "12:30:00",
    "2026-01-01", "- a", "a: b", "#", "two\nlines\n", "\ttab", "é ü 漢", "\x07", "'", '"', "{}", "[]", "&a", "*a", "!t",
    "%", "@", "`", "=", "<<", "x" * 500,
)  # fmt: skip


@pytest.mark.parametrize("text", TEXTS)
def test_a_text_stays_a_text(text: str) -> None:
    """Whatever looks like a number, a date or syntax comes back as the same text, as a value and as a key."""
    data = {"value": text, "list": [text, {text: 1}]}
    assert load_yaml(yaml_text(data), "test") == data


def test_plain_data_comes_back_in_its_order() -> None:
    """Numbers, truth values, nothing and order survive; what is there twice is written twice."""
    shared = {"b": 1, "a": [True, None, -2.5, 1e-9, 3]}
    data = {"z": shared, "y": [shared, {}, []]}
    text = yaml_text(data)
    assert load_yaml(text, "test") == data
    assert list(load_yaml(text, "test")["z"]) == ["b", "a"]
    assert "&" not in text
