"""What a message costs: encoding, decoding, cleaning what DDS delivers, joining, and writing and reading logs."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from itertools import count
from pathlib import Path
from time import perf_counter, process_time

import numpy as np
from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer

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
PER_TICK = sum(not topic.sporadic and not topic.optional for topic in LOGGED)
# In the log a tick has its transforms and its angles, too.
IN_LOG = PER_TICK + 1 + len(SOURCES)


def run() -> dict[str, float]:
    """Costs per message of a robot with seven joints, best of a few repeats."""
    ticks = made_ticks()
    return _codecs(ticks[1]) | _joining() | _log(ticks) | beside_mcap(ticks, REPEATS)


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


def beside_mcap(ticks: Sequence[Tick], repeats: int) -> dict[str, float]:
    """Values to an indexed file beside mcap's own writer, which gets the same messages as bytes; CPU time, in turns.

    Args:
        ticks: of the robot of this benchmark.
        repeats: turns; the least time of each counts.
    """
    header, own = LogHeader("", _urdf(), 0, NAMES), list[float]()
    raw: dict[CompressionType, list[float]] = {kind: [] for kind in (CompressionType.ZSTD, CompressionType.NONE)}
    with tempfile.TemporaryDirectory() as scratch:
        for repeat in range(repeats):
            sink = LogSink(Path(scratch) / f"own{repeat}", header)
            own.append(_seconds(lambda sink=sink: _written(sink, ticks), process_time))
            with sink.writer.path.open("rb") as stream:
                rows = [(one.channel_id, one.log_time, one.data) for *_, one in make_reader(stream).iter_messages()]
            for kind, times in raw.items():
                path = Path(scratch) / f"raw_{kind.name}.mcap"
                times.append(_seconds(lambda rows=rows, path=path, kind=kind: _raw(path, rows, kind), process_time))
    return {
        "log: write and close, times the speed of mcap's writer, zstd": min(raw[CompressionType.ZSTD]) / min(own),
        "log: write and close, times the speed of mcap's writer, plain": min(raw[CompressionType.NONE]) / min(own),
    }


def _written(sink: LogSink, ticks: Sequence[Tick]) -> None:
    for tick in ticks:
        sink.record(tick)
    sink.close("completed")


def _raw(path: Path, rows: Sequence[tuple[int, int, bytes]], kind: CompressionType) -> None:
    with path.open("wb") as stream:
        writer = Writer(stream, compression=kind)
        writer.start()
        schema = writer.register_schema("schema", "ros2msg", b"")
        channels = {number: writer.register_channel(f"/{number}", "cdr", schema) for number in {row[0] for row in rows}}
        for number, stamp, data in rows:
            writer.add_message(channels[number], stamp, data, stamp)
        writer.finish()


def _urdf() -> str:
    """A chain of the joints."""
    links = ["base_link", *(f"link{index + 1}" for index in range(JOINTS))]
    joints = [
        f'<joint name="{name}" type="revolute"><origin xyz="0 0 0.3" rpy="0.1 0.2 0.3"/><axis xyz="0 0 1"/>'
        f'<parent link="{links[index]}"/><child link="{links[index + 1]}"/></joint>'
        for index, name in enumerate(NAMES)
    ]
    return f"<robot name='chain'>{''.join(f'<link name={link!r}/>' for link in links)}{''.join(joints)}</robot>"


def made_ticks(count: int = TICKS) -> list[Tick]:
    """Ticks of random numbers."""
    rng = np.random.default_rng(0)
    ticks = []
    for stamp in range(0, count * PERIOD, PERIOD):
        q, v, effort = rng.normal(size=7 + JOINTS), rng.normal(size=6 + JOINTS), rng.normal(size=JOINTS)
        telemetry = Telemetry.of(stamp, {"error": v, "surface": v, "rate": 1.0})
        state = RobotState(stamp, q, v, effort, rng.normal(size=3))
        output = ControlOutput(Command(stamp, v[:6], effort), telemetry)
        ticks.append(Tick(PlantSample(state, telemetry), Reference(stamp, q, v, v), output))
    return ticks


def _us(function: Callable[[], object], number: int = 2000) -> float:
    """Microseconds per call, best of REPEATS."""
    return 1e6 * min(_seconds(lambda: [function() for _ in range(number)]) for _ in range(REPEATS)) / number


def _seconds(function: Callable[[], object], clock: Callable[[], float] = perf_counter) -> float:
    begin = clock()
    function()
    return clock() - begin
