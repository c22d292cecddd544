"""What a message costs: encoding, decoding, cleaning what DDS delivers, joining, and writing and reading logs."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from itertools import count
from pathlib import Path
from time import perf_counter

import numpy as np

from space_robot_msgs_py.attitude import SOURCES, AttitudeAngles
from space_robot_msgs_py.codec.codecs import LOGGED, TickCodec, TopicBytes, peek_stamp
from space_robot_msgs_py.codec.generic import canonical_message
from space_robot_msgs_py.interfaces import Command, ControlOutput, PlantSample, Reference, RobotState, Telemetry, Tick
from space_robot_msgs_py.joiner import StampJoiner
from space_robot_msgs_py.log.header import LogHeader
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.log.writer import LogSink
from space_robot_msgs_py.topics import ATTITUDE
from space_robot_msgs_py.transforms import FrameTransforms

JOINTS = 7
TICKS = 1500
PERIOD = 100_000_000
REPEATS = 5
NAMES = tuple(f"joint{index + 1}" for index in range(JOINTS))
PER_TICK = sum(not topic.sporadic for topic in LOGGED)
# In the log a tick has its transforms and its angles, too.
IN_LOG = PER_TICK + 1 + len(SOURCES)


def run() -> dict[str, float]:
    """Costs per message of a robot with seven joints, best of a few repeats."""
    ticks = _ticks()
    return _codecs(ticks[1]) | _joining() | _log(ticks)


def _codecs(tick: Tick) -> dict[str, float]:
    codec, canonical = TickCodec(NAMES), TopicBytes(NAMES)
    raws = codec.encode(tick)
    frames, angles = FrameTransforms(_urdf(), NAMES), AttitudeAngles(ATTITUDE)
    pairs = [(topic, raw) for topic, raw in zip(LOGGED, raws, strict=True) if raw is not None]
    parts = {topic.name: raw for topic, raw in pairs}
    state = codec.state.encode(tick.sample.state)
    command = codec.command.encode(tick.output.command)
    return {
        "encode a tick, us/message": _us(lambda: codec.encode(tick)) / PER_TICK,
        "encode a state (3 messages), us": _us(lambda: codec.state.encode(tick.sample.state)),
        "decode a tick, us/message": _us(lambda: codec.decode(parts)) / PER_TICK,
        "decode a state (3 messages), us": _us(lambda: codec.state.decode(state)),
        "decode a command (2 messages), us": _us(lambda: codec.command.decode(command)),
        "transforms of a state, us": _us(lambda: frames.from_messages(*state[:2])),
        "angles of a state, us": _us(lambda: angles.of(state[0])),
        "peek at a stamp, us": _us(lambda: peek_stamp(state[0])),
        "canonical form by layout, us/message": _us(lambda: [canonical.read(*pair) for pair in pairs]) / PER_TICK,
        "canonical form by rosbags, us/message": _us(
            lambda: [canonical_message(topic.type, raw) for topic, raw in pairs], number=50
        )
        / PER_TICK,
    }


def _joining() -> dict[str, float]:
    joiner: StampJoiner[bytes] = StampJoiner(6, 1024)
    stamps = count()

    def join() -> None:
        stamp = next(stamps)
        for part in range(6):
            joiner.add(part, stamp, b"")

    return {"join 6 parts, us/message": _us(join) / 6}


def _log(ticks: list[Tick]) -> dict[str, float]:
    writing, closing, reading, stacking = [], [], [], []
    header = LogHeader("", _urdf(), 0, NAMES)
    with tempfile.TemporaryDirectory() as scratch:
        for repeat in range(REPEATS):
            sink = LogSink(Path(scratch) / f"run{repeat}", header)
            writing.append(_seconds(lambda sink=sink: [sink.record(tick) for tick in ticks]))
            closing.append(_seconds(lambda sink=sink: sink.close("completed")))
            reader = LogReader(sink.writer.path)
            reading.append(_seconds(lambda reader=reader: sum(1 for _ in reader.ticks())))
            stacking.append(_seconds(reader.arrays))
    messages = TICKS * IN_LOG
    return {
        "log: values to disk, flushed every tick, us/message": 1e6 * min(writing) / messages,
        "log: values to disk, messages/s": messages / min(writing),
        f"log: close and index {TICKS} ticks, ms": 1e3 * min(closing),
        "log: write and close, messages/s": messages / (min(writing) + min(closing)),
        "log: read as ticks, messages/s": messages / min(reading),
        "log: read as arrays, messages/s": messages / min(stacking),
    }


def _urdf() -> str:
    """A chain of the joints."""
    links = ["base_link", *(f"link{index + 1}" for index in range(JOINTS))]
    joints = [
        f'<joint name="{name}" type="revolute"><origin xyz="0 0 0.3" rpy="0.1 0.2 0.3"/><axis xyz="0 0 1"/>'
        f'<parent link="{links[index]}"/><child link="{links[index + 1]}"/></joint>'
        for index, name in enumerate(NAMES)
    ]
    return f"<robot name='chain'>{''.join(f'<link name={link!r}/>' for link in links)}{''.join(joints)}</robot>"


def _ticks() -> list[Tick]:
    rng = np.random.default_rng(0)
    ticks = []
    for stamp in range(0, TICKS * PERIOD, PERIOD):
        q, v, effort = rng.normal(size=7 + JOINTS), rng.normal(size=6 + JOINTS), rng.normal(size=JOINTS)
        telemetry = Telemetry.of(stamp, {"error": v, "surface": v, "rate": 1.0})
        state = RobotState(stamp, q, v, effort, rng.normal(size=3))
        output = ControlOutput(Command(stamp, v[:6], effort), telemetry)
        ticks.append(Tick(PlantSample(state, telemetry), Reference(stamp, q, v, v), output))
    return ticks


def _us(function: Callable[[], object], number: int = 2000) -> float:
    """Microseconds per call, best of REPEATS."""
    return 1e6 * min(_seconds(lambda: [function() for _ in range(number)]) for _ in range(REPEATS)) / number


def _seconds(function: Callable[[], object]) -> float:
    begin = perf_counter()
    function()
    return perf_counter() - begin
