"""Decisions of a supervisor as messages: read as written, canonical, and nothing else passes for one."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from space_robot_msgs_py.codec.codecs import (
    SupervisionCodec,
    TopicBytes,
    encode_statuses,
    encode_tick_housekeeping,
    encode_tick_statuses,
    is_empty,
)
from space_robot_msgs_py.codec.telemetry import TelemetryCodec
from space_robot_msgs_py.errors import LayoutError
from space_robot_msgs_py.events import OK, DiagnosticEvent
from space_robot_msgs_py.interfaces import Supervision, Telemetry
from space_robot_msgs_py.topics import EVENTS, HOUSEKEEPING, SUPERVISOR_MODE
from tests.support import values

SECOND = 1_000_000_000
CODEC = SupervisionCodec()
LAW = (("law", "pd"), ("reference", "here"))


@st.composite
def decisions(draw: st.DrawFn) -> Supervision:
    """Any decision, without events and housekeeping."""
    stamp = draw(st.integers(0, 10**15))
    answer = draw(st.one_of(st.just(-1), st.integers(0, stamp)))
    mode, law, reference = draw(values.texts), draw(values.texts), draw(st.sampled_from(["follow", "freeze", "here"]))
    flags = {"brakes": draw(st.booleans()), "unload": draw(st.booleans())}
    return Supervision(stamp, mode, law, reference, draw(st.integers(0, stamp)), answer, **flags)


@given(decisions())
def test_a_decision_is_read_as_it_was_written(decision: Supervision) -> None:
    """Every field, with a codec of its own at either end, and the bytes are canonical."""
    raw = CODEC.encode(decision)
    assert values.bits(SupervisionCodec().decode(raw)) == values.bits(decision)
    assert TopicBytes(values.NAMES).read(SUPERVISOR_MODE, raw) == (decision.stamp, raw)


def test_only_the_stamp_changes_within_a_mode() -> None:
    """Two ticks of a mode differ in the eight bytes of their stamps."""
    first, second = (
        CODEC.encode(Supervision(k * SECOND, "HOLD", "controller", "here", 0, (k - 1) * SECOND)) for k in (3, 4)
    )
    assert first[:4] == second[:4]
    assert first[4:12] != second[4:12]
    assert first[12:] == second[12:]


@pytest.mark.parametrize(
    "events",
    [
        [DiagnosticEvent(0, OK, "tumbling", "fires")],
        [DiagnosticEvent(0, OK, "mode", "NOMINAL")],
        [
            DiagnosticEvent(
                0, OK, "mode", "A", "", (("law", "pd"), ("reference", "here"), ("since", "-1"), ("answer", "0"))
            )
        ],
        [
            DiagnosticEvent(
                0, OK, "mode", "A", "", (("law", "pd"), ("reference", "here"), ("since", "0"), ("answer", "x"))
            )
        ],
    ],
)
def test_other_statuses_are_no_modes(events: list[DiagnosticEvent]) -> None:
    """Another name, other keys, numbers that are none."""
    with pytest.raises(LayoutError):
        CODEC.decode(encode_statuses(events))


@given(st.binary(max_size=200))
def test_noise_is_refused(raw: bytes) -> None:
    """Whatever it is, it raises LayoutError and nothing else."""
    with pytest.raises(LayoutError):
        CODEC.decode(raw)


def test_empty_messages_are_recognised_by_their_topic() -> None:
    """Of housekeeping the stamp alone, of events no status; with content neither."""
    codec = TelemetryCodec(HOUSEKEEPING)
    assert is_empty(HOUSEKEEPING, encode_tick_housekeeping(codec, SECOND, None))
    assert not is_empty(HOUSEKEEPING, encode_tick_housekeeping(codec, SECOND, Telemetry.of(SECOND, {"mode": 0.0})))
    assert is_empty(EVENTS, encode_tick_statuses(SECOND, ()))
    assert not is_empty(EVENTS, encode_tick_statuses(SECOND, [DiagnosticEvent(SECOND, OK, "a", "fires")]))
    assert not is_empty(SUPERVISOR_MODE, CODEC.encode(Supervision(0, "A", "controller", "follow", 0)))
