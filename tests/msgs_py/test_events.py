"""Events of a controller as text: what goes in comes out, and what is none is refused."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from space_robot_msgs_py.codec.codecs import TopicBytes, decode_events, encode_events, encode_string
from space_robot_msgs_py.errors import LayoutError
from space_robot_msgs_py.events import ControllerEvent
from space_robot_msgs_py.topics import CONTROLLER_EVENTS

plain = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
    max_leaves=8,
)


@given(st.integers(0, 2**62), st.lists(plain, min_size=1, max_size=3))
def test_events_of_a_stamp_survive_the_wire(stamp: int, contents: list[object]) -> None:
    """Any plain content of one or more events is read back equal, one line each, and the recorder finds the stamp."""
    events = tuple(ControllerEvent(stamp, "parameters", {"values": content}) for content in contents)
    raw = encode_events(events)
    assert decode_events(raw) == events
    assert all("\n" not in event.line for event in events)
    assert TopicBytes(("joint",)).read(CONTROLLER_EVENTS, raw) == (stamp, raw)


NO_EVENTS = (
    *("", "no JSON", "[1]", "[" * 10_000),
    *('{"kind": "switch"}', '{"stamp": 1}', '{"stamp": -1, "kind": "a"}'),
    *('{"stamp": 1.5, "kind": "a"}', '{"stamp": true, "kind": "a"}', '{"stamp": 1, "kind": 2}'),
    *('{"stamp": 1, "kind": "a", "values": NaN}', '{"stamp": 1, "kind": "a", "values": [1e999]}'),
    *('{"stamp": 1, "kind": "a"}\n{"stamp": 2, "kind": "a"}', '{"stamp": 1, "kind": "a"}\n'),
)


@pytest.mark.parametrize("text", NO_EVENTS)
def test_a_malformed_event_is_refused(text: str) -> None:
    """Text of a stranger is a LayoutError, whatever is wrong with it."""
    with pytest.raises(LayoutError):
        decode_events(encode_string(text))
