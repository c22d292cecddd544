"""Values of the data flow for tests: arbitrary ones for properties, and a reproducible run of ticks."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from space_robot_msgs_py.events import ERROR, OK, WARN, ControllerEvent, DiagnosticEvent
from space_robot_msgs_py.interfaces import (
    Command,
    ControlOutput,
    PlantSample,
    Reference,
    RobotState,
    Supervision,
    Telemetry,
    Tick,
)
from space_robot_msgs_py.log.header import LogHeader

PERIOD = 100_000_000
NAMES = ("shoulder", "elbow", "wrist")
HEADER = LogHeader(
    "seed: 7\nname: test\n",
    '<robot name="t"/>',
    7,
    NAMES,
    {"numpy": "2", "mcap": "1"},
    topics=("events", "faults", "plant/events", "housekeeping", "supervisor/mode", "base/wheel_momentum"),
)

joint_counts = st.integers(1, 14)
stamps = st.integers(0, 2**53 - 1)
numbers = st.floats(allow_nan=False, allow_infinity=False)
texts = st.text(st.characters(exclude_characters="\0", exclude_categories=("Cs",)), max_size=12)


def vectors(size):
    """Arrays of that many finite numbers, subnormals and signed zeros among them."""
    return hnp.arrays(np.float64, size, elements=numbers)


@st.composite
def joint_names(draw):
    """1 to 14 distinct joint names of any length, so of any alignment."""
    count = draw(joint_counts)
    return tuple(draw(st.lists(texts, min_size=count, max_size=count, unique=True)))


@st.composite
def states(draw, n):
    """RobotState of n joints."""
    parts = (draw(vectors(size)) for size in (7 + n, 6 + n, n, 3))
    return RobotState(draw(stamps), *parts)


@st.composite
def references(draw, n):
    """Reference of n joints."""
    parts = (draw(vectors(size)) for size in (7 + n, 6 + n, 6 + n))
    return Reference(draw(stamps), *parts)


@st.composite
def commands(draw, n):
    """Command of n joints."""
    return Command(draw(stamps), draw(vectors(6)), draw(vectors(n)))


@st.composite
def telemetries(draw):
    """Telemetry with up to six blocks, empty ones among them."""
    labels = draw(st.lists(texts.filter(lambda text: text != "stamp"), max_size=6, unique=True))
    sizes = draw(st.lists(st.integers(0, 5), min_size=len(labels), max_size=len(labels)))
    return Telemetry(draw(stamps), tuple(labels), tuple(sizes), draw(vectors(sum(sizes))))


def run_ticks(count, *, n=3, seed=0):
    """The ticks of a run of random numbers, the same for the same seed."""
    rng = np.random.default_rng(seed)
    return [_tick(k * PERIOD, n, rng) for k in range(count)]


def _tick(stamp, n, rng):
    parts = (rng.normal(size=size) for size in (7 + n, 6 + n, n, 3, 3))
    state = RobotState(stamp, *parts)
    reference = Reference(stamp, rng.normal(size=7 + n), rng.normal(size=6 + n), rng.normal(size=6 + n))
    telemetry = Telemetry.of(stamp, {"error": rng.normal(size=n), "gain": rng.normal()})
    events = (
        ControllerEvent(stamp, "parameters", {"values": {"gains.level": float(rng.normal())}}),
        ControllerEvent(stamp, "switch", {"from": "a", "to": "b"}),
    )
    found = (DiagnosticEvent(stamp, OK, "mode", "NOMINAL -> SAFE", "", (("cause", "tumbling"),)),)
    output = ControlOutput(Command(stamp, rng.normal(size=6), rng.normal(size=n)), telemetry, events)
    summary = Telemetry.of(stamp, {"mode": 1.0, "base.rate": 1e-9 * stamp})
    supervision = Supervision(stamp, "SAFE", "detumble", "here", 0, max(-1, stamp - PERIOD), found, summary)
    faults = (
        DiagnosticEvent(
            stamp, ERROR, "joint_stuck elbow", "begins", "elbow", (("kind", "joint_stuck"), ("joint", "elbow"))
        ),
        DiagnosticEvent(stamp, OK, "sensor_noise attitude", "ends"),
    )
    refused = (DiagnosticEvent(stamp, WARN, "command refused", "rate", "", (("stamp", "0"), ("count", "1"))),)
    sample = PlantSample(state, Telemetry.of(stamp, {"energy": rng.normal()}), faults, refused)
    return Tick(sample, reference, output, supervision)


def blocks_equal(first, second):
    """Whether two sequences of arrays hold the same bits."""
    return len(first) == len(second) and all(a.tobytes() == b.tobytes() for a, b in zip(first, second, strict=True))


def bits(value):
    """Everything in a value, as something that is equal only for equal bits."""
    if isinstance(value, np.ndarray):
        return value.dtype.str, value.shape, value.tobytes()
    if hasattr(value, "__dataclass_fields__"):
        return type(value).__name__, tuple(bits(getattr(value, name)) for name in value.__dataclass_fields__)
    return value
