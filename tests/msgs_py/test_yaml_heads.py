"""What stands at the top of a YAML file, without the rest of it."""

from __future__ import annotations

import pytest

from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.yaml_heads import top_texts

TEXT = """
a: &x [title, {title: inner}]
*x : alias as a key
b: {title: deeper}
c: *x
title: >-
  two
  lines
late: 1
"""


def test_only_scalars_of_the_top_are_found() -> None:
    """Not what stands deeper, in lists, behind aliases; what is not there is left out."""
    assert top_texts(TEXT.replace("*x : alias as a key\n", ""), ("title", "late", "none"), "test") == {
        "title": "two lines",
        "late": "1",
    }
    assert top_texts("", ("title",), "test") == {}
    assert top_texts("[title, x]", ("title",), "test") == {}


def test_nothing_is_read_behind_the_last_key() -> None:
    """What is wrong before it is said with the name of the file."""
    assert top_texts("title: x\nbroken: [", ("title",), "test") == {"title": "x"}
    with pytest.raises(SpecError, match="test: not valid YAML"):
        top_texts("broken: [\ntitle: x\n", ("title",), "test")
