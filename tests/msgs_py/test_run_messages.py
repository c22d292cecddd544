"""What nodes say of a run as a whole."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from space_robot_msgs_py.codec.codecs import encode_string
from space_robot_msgs_py.errors import LayoutError
from space_robot_msgs_py.run_messages import RunBegin, RunEnd, decode_begin, decode_end, encode_begin, encode_end

texts = st.text(st.characters(exclude_categories=["Cs"]))


@given(run=texts, node=texts, reason=texts)
def test_an_end_comes_back(run: str, node: str, reason: str) -> None:
    """Whatever a reason quotes, it is the same text at the other side."""
    assert decode_end(encode_end(RunEnd(run, node, reason))) == RunEnd(run, node, reason)


@given(run=texts.filter(bool), number=st.integers(0, 1 << 40))
def test_a_begin_comes_back(run: str, number: int) -> None:
    """Name and number are the same at the other side."""
    assert decode_begin(encode_begin(RunBegin(run, number))) == RunBegin(run, number)


HOSTILE = ["", "completed", "[]", "{}", '{"run": 1}', '{"run": "", "number": 0}', '{"run": "a", "number": -1}']
HOSTILE += ['{"run": "a", "number": true}', '{"run": "a", "node": "b", "reason": null}', "[" * 10_000, "NaN"]


@pytest.mark.parametrize("text", HOSTILE)
def test_what_is_neither_is_refused(text: str) -> None:
    """Another text, type or name is a LayoutError with what is accepted."""
    for decode in (decode_begin, decode_end):
        with pytest.raises(LayoutError):
            decode(encode_string(text))
    for raw in (b"", b"\x00\x01\x00\x00\xff\xff\xff\xff"):
        with pytest.raises(LayoutError):
            decode_end(raw)
