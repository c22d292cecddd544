"""Bags as other tools write them, with the messages of a run of the project."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from mcap.writer import CompressionType
from mcap_ros2.decoder import DecoderFactory
from mcap_ros2.writer import Writer as McapRos2Writer
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer

from space_robot_bringup.logs.foreign_bag import Source
from space_robot_msgs_py.codec.cdr import with_stamp
from space_robot_msgs_py.codec.schemas import schema_text, typestore
from space_robot_msgs_py.codec.texts import peek_stamp
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.topics import TABLE

# A recording has wall times, and messages arrive in another order than they belong together.
WALL, LATENCY = 1_750_000_000_000_000_000, {"reference/base": -300_000_000, "joint_command": 90_000_000}
TYPES = {topic.name: topic.type for topic in TABLE}
SHORT = "duration=3.0"
STAMPED = ("base/odom", "joint_states", "base/imu", "reference/base", "reference/base_accel", "reference/joints")
FIRST = Source(start="first")


def recorded(log: Path, drop: tuple[str, ...] = ()) -> Iterator[tuple[str, int, bytes]]:
    """Topic, time and bytes of every message, as a recorder would have heard them."""
    heard = [
        (WALL + stamp + LATENCY.get(name, 0), name, raw)
        for name, stamp, raw in LogReader(log).messages()
        if name in TYPES and not name.startswith("/tf") and name not in drop
    ]
    for time, name, raw in sorted(heard, key=lambda item: item[0]):
        yield name, time, dirty(raw)


def dirty(raw: bytes) -> bytes:
    """The same message with options in its encapsulation and bytes behind it, as Fast DDS sends it."""
    return raw[:2] + b"\x00\x03" + raw[4:] + b"\x00" * 3


def write(form: str, log: Path, place: Path, drop: tuple[str, ...] = ()) -> Path:
    """A bag of that form."""
    if form in ("rosbags", "sqlite", "message", "file", "storage"):
        with_rosbags(form, log, place, drop)
    elif form == "split":
        messages = list(recorded(log, drop))
        third = len(messages) // 3
        place.mkdir()
        # The tenth file comes after the second, whatever the alphabet says.
        for number, part in enumerate((messages[:third], messages[third : 2 * third], messages[2 * third :])):
            with_mcap(place / f"{place.name}_{(2, 9, 10)[number]}.mcap", part, CompressionType.ZSTD)
    else:
        place.mkdir()
        kind = {"lz4": CompressionType.LZ4, "zstd": CompressionType.ZSTD}.get(form, CompressionType.NONE)
        prefix = "/robot1" if form == "namespace" else ""
        with_mcap(place / f"{place.name}_0.mcap", recorded(log, drop), kind, prefix)
    return place


def with_rosbags(form: str, log: Path, place: Path, drop: tuple[str, ...]) -> None:
    plugin = StoragePlugin.MCAP if form in ("rosbags", "storage") else StoragePlugin.SQLITE3
    writer = Writer(place, version=9, storage_plugin=plugin)
    if form in ("message", "file", "storage"):
        writer.set_compression(CompressionMode[form.upper()], CompressionFormat.ZSTD)
    with writer:
        connections: dict[str, Any] = {}
        for name, time, raw in recorded(log, drop):
            if name not in connections:
                connections[name] = writer.add_connection(f"/{name}", TYPES[name], typestore=typestore())
            writer.write(connections[name], time, raw)


def with_mcap(path: Path, messages: Any, compression: CompressionType, prefix: str = "") -> None:
    """As mcap_ros2 writes: decoded and encoded again by its own code."""
    with path.open("wb") as stream:
        writer = McapRos2Writer(stream, chunk_size=40_000, compression=compression)
        schemas = {ros_type: writer.register_msgdef(ros_type, schema_text(ros_type)) for ros_type in TYPES.values()}
        for name, time, raw in messages:
            schema = schemas[TYPES[name]]
            decode = DecoderFactory().decoder_for("cdr", schema)
            assert decode is not None
            writer.write_message(f"{prefix}/{name}", schema, decode(raw), log_time=time, publish_time=time)
        writer.finish()


def since_1970(log: Path, drop: tuple[str, ...] = ()) -> Iterator[tuple[str, int, bytes]]:
    """The messages of a run as a robot sends them that has only the wall clock."""
    for name, time, raw in recorded(log, drop):
        headed = name in STAMPED or "command" in name
        yield name, time, with_stamp(raw, peek_stamp(raw) + WALL) if headed else raw
