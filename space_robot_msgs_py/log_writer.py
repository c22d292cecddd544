"""Writes a run as a rosbag2 bag that survives a kill at any time; equal ticks give equal files."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO

from space_robot_msgs_py.codecs import LOGGED, TickCodec, encode_string
from space_robot_msgs_py.errors import LogError
from space_robot_msgs_py.interfaces import PlantSample, Reference, Tick
from space_robot_msgs_py.log_directory import TEMPORARY, prepare_directory, recorded_topics, write_metadata_yaml
from space_robot_msgs_py.log_header import LogHeader
from space_robot_msgs_py.log_preamble import CHANNELS, END_NAME, preamble
from space_robot_msgs_py.mcap_index import write_indexed
from space_robot_msgs_py.mcap_records import message_bytes, metadata_bytes
from space_robot_msgs_py.paths import StrPath
from space_robot_msgs_py.topics import BASE_ODOM, JOINT_STATES, ROBOT_DESCRIPTION, TF, TF_STATIC, Topic
from space_robot_msgs_py.transforms import FrameTransforms

_IDS = tuple(CHANNELS[topic.name] for topic in LOGGED)
_BASE, _JOINTS = LOGGED.index(BASE_ODOM), LOGGED.index(JOINT_STATES)


class LogWriter:
    """Appends whole ticks to ``<directory>/<name>_0.mcap`` and indexes the file when it is closed.

    While the run goes on the file is a plain sequence of records, flushed after every tick: a SIGKILL loses at most
    the tick being written. All times are stamps; no wall clock and no name of a machine gets into the file.

    Transforms follow from the state: the writer makes them, so that the log of every mode has them, with the same bits.

    Args:
        directory: run directory; it is made, a previous run in it is replaced, anything else in it is refused.
        header: provenance, written first.
        custom: remarks for ``metadata.yaml`` such as the mode; they are not in the .mcap.

    Raises:
        LogError: the directory holds something else, or cannot be written.
    """

    def __init__(self, directory: StrPath, header: LogHeader, *, custom: Mapping[str, str] | None = None) -> None:
        self.path = prepare_directory(Path(directory))
        self._custom = dict(custom or {})
        self._frames = FrameTransforms(header.urdf, header.joint_names)
        self._counts = dict.fromkeys(CHANNELS, 0)
        self._last = -1
        self._ticks = 0
        self._stream: IO[bytes] | None = None
        with self._guarded():
            self._stream = self.path.open("wb")
        self._append(preamble(header))

    def write_description(self, urdf: str) -> None:
        """Write ``robot_description`` and ``/tf_static`` at stamp 0, before the first tick."""
        if self._ticks or self._counts[ROBOT_DESCRIPTION.name]:
            raise LogError("the description is the first message and the only one of its kind", key=str(self.path))
        records = [self._record(ROBOT_DESCRIPTION, 0, encode_string(urdf))]
        if self._frames.static is not None:
            records.append(self._record(TF_STATIC, 0, self._frames.static))
        self._append(b"".join(records))

    def write_tick(self, stamp: int, parts: Mapping[Topic, bytes]) -> None:
        """Write the messages of one stamp in table order; topics may be absent.

        Args:
            stamp: [ns], later than the one before.
            parts: canonical bytes by topic.

        Raises:
            LogError: a topic is not recorded by tick, time does not go on, or the disk refuses.
        """
        row = [parts.get(topic) for topic in LOGGED]
        if len(parts) != len(row) - row.count(None):
            unknown = next(topic.name for topic in parts if topic not in LOGGED)
            accepted = ", ".join(topic.name for topic in LOGGED)
            raise LogError("not a topic of a tick", key=str(self.path), value=unknown, accepted=accepted)
        self.write_row(stamp, row)

    def write_row(self, stamp: int, row: Sequence[bytes | None]) -> None:
        """Write the messages of one stamp, given in the order of ``LOGGED``; None where there is none."""
        if stamp <= self._last:
            raise LogError(
                "time does not go on", key=str(self.path), value=stamp, accepted=f"more than {self._last} ns"
            )
        records = []
        for topic, channel, data in zip(LOGGED, _IDS, row, strict=True):
            if data is not None:
                records.append(message_bytes(channel, self._counts[topic.name], stamp, data))
                self._counts[topic.name] += 1
        transforms = self._frames.from_messages(row[_BASE], row[_JOINTS])
        if transforms is not None:
            records.append(self._record(TF, stamp, transforms))
        self._append(b"".join(records))
        self._last = stamp
        self._ticks += 1

    def close(self, reason: str) -> None:
        """Write the reason of the end, index the file and write ``metadata.yaml``; later calls do nothing.

        A kill at any time in here leaves a readable file: the indexed one replaces the plain one at once.

        Raises:
            LogError: the disk refuses; the plain file stays.
        """
        if self._stream is None:
            return
        self._append(metadata_bytes(END_NAME, {"reason": reason, "ticks": str(self._ticks)}))
        temporary = self.path.with_name(self.path.name + TEMPORARY)
        with self._guarded(leftover=temporary):
            self._stream.close()
            self._stream = None
            write_indexed(self.path, temporary)
            temporary.replace(self.path)
            custom = self._custom | {"end_reason": reason}
            write_metadata_yaml(self.path, recorded_topics(self._counts), last_stamp=max(self._last, 0), custom=custom)

    def _record(self, topic: Topic, stamp: int, data: bytes) -> bytes:
        sequence = self._counts[topic.name]
        self._counts[topic.name] += 1
        return message_bytes(CHANNELS[topic.name], sequence, stamp, data)

    def _append(self, data: bytes) -> None:
        if self._stream is None:
            raise LogError("the log is closed", key=str(self.path))
        with self._guarded():
            self._stream.write(data)
            self._stream.flush()

    @contextmanager
    def _guarded(self, leftover: Path | None = None) -> Iterator[None]:
        """Whatever the disk refuses becomes one LogError; the log is then closed for good."""
        try:
            yield
        except OSError as error:
            stream, self._stream = self._stream, None
            if stream is not None:
                with suppress(OSError):
                    stream.close()
            if leftover is not None:
                with suppress(OSError):
                    leftover.unlink()
            raise LogError(f"the log cannot be written: {error.strerror or error}", key=str(self.path)) from None


class LogSink:
    """A Sink that writes values to a log.

    Args:
        directory: run directory, see LogWriter.
        header: provenance; its URDF is also the first message.
        custom: remarks for ``metadata.yaml``.
    """

    def __init__(self, directory: StrPath, header: LogHeader, *, custom: Mapping[str, str] | None = None) -> None:
        self._codec = TickCodec(header.joint_names)
        self.writer = LogWriter(directory, header, custom=custom)
        self.writer.write_description(header.urdf)

    def record(self, tick: Tick) -> None:
        """Write one tick; it is in the file when this returns."""
        self.writer.write_row(tick.stamp, self._codec.encode(tick))

    def record_unanswered(self, sample: PlantSample, reference: Reference) -> None:
        """Write the last state of a run whose controller had no answer; it is no complete tick."""
        self.writer.write_row(sample.state.stamp, self._codec.encode_unanswered(sample, reference))

    def close(self, reason: str) -> None:
        """Close the log; later calls do nothing."""
        self.writer.close(reason)


class MemorySink:
    """A Sink that keeps the ticks.

    Attributes:
        ticks: all ticks so far.
        unanswered: the state and reference the controller had no answer to, if there was one.
        end_reason: None until closed.
    """

    def __init__(self) -> None:
        self.ticks: list[Tick] = []
        self.unanswered: tuple[PlantSample, Reference] | None = None
        self.end_reason: str | None = None

    def record(self, tick: Tick) -> None:
        """Keep one tick."""
        self.ticks.append(tick)

    def record_unanswered(self, sample: PlantSample, reference: Reference) -> None:
        """Keep what had no answer."""
        self.unanswered = (sample, reference)

    def close(self, reason: str) -> None:
        """Keep the reason; the first one counts."""
        if self.end_reason is None:
            self.end_reason = reason
