"""Writes a run as a rosbag2 bag that survives a kill at any time; equal ticks give equal files."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO

from space_robot_msgs_py.attitude import SOURCES, AttitudeAngles
from space_robot_msgs_py.codec.codecs import LOGGED, TickCodec, encode_string
from space_robot_msgs_py.errors import LogError
from space_robot_msgs_py.interfaces import PlantSample, Reference, Supervision, Tick
from space_robot_msgs_py.log.arrays import LogArrays, arrays_of
from space_robot_msgs_py.log.closing import Written, append_end, finish_bag, write_all
from space_robot_msgs_py.log.header import LogHeader
from space_robot_msgs_py.log.mcap.positions import Shape
from space_robot_msgs_py.log.mcap.records import message_bytes
from space_robot_msgs_py.log.preamble import CHANNELS, channels_of, preamble
from space_robot_msgs_py.log.row_form import NONE, Rows, sizes_of
from space_robot_msgs_py.log.run_directory import RunDirectory, WatchedFile
from space_robot_msgs_py.log.tick_block import TickBlock, ordinary
from space_robot_msgs_py.paths import StrPath
from space_robot_msgs_py.topics import BASE_ODOM, JOINT_STATES, ROBOT_DESCRIPTION, TF, TF_STATIC, Topic
from space_robot_msgs_py.transforms import FrameTransforms

_BASE, _JOINTS = LOGGED.index(BASE_ODOM), LOGGED.index(JOINT_STATES)
# The angles of the measured attitude, then those of the desired one.
_ANGLES = tuple((AttitudeAngles(topic), LOGGED.index(source)) for topic, (source, _) in SOURCES.items())
# The columns of a row: what a tick consists of, then what follows from it.
_NAMES = tuple(topic.name for topic in (*LOGGED, TF, *SOURCES))
_IDS = tuple(CHANNELS[name] for name in _NAMES)
_NO_MESSAGES = (NONE,) * len(LOGGED)


class LogWriter:
    """Appends whole ticks to ``<directory>/<name>_0.mcap`` and indexes the file when it is closed.

    While the run goes on the file is a plain sequence of records, flushed after every tick: a SIGKILL loses at most
    the tick being written. All times are stamps; no wall clock and no name of a machine gets into the file.

    Transforms and angles follow from state and reference: the writer makes them, so that the log of every mode has
    them, with the same bits.

    Every file is reached through the open directory, and no other run can write there meanwhile. A file that is no
    longer where it was, or a disk that takes no more, ends the log with a reason that says so, where one still fits.

    Args:
        directory: run directory; it is made, a previous run in it is replaced, anything else in it is refused. One that
            was opened and locked before stays so.
        header: provenance, written first.
        custom: remarks for ``metadata.yaml`` such as the mode; they are not in the .mcap.

    Raises:
        LogError: the directory holds something else, another run writes to it, or it cannot be written.
    """

    def __init__(
        self, directory: StrPath | RunDirectory, header: LogHeader, *, custom: Mapping[str, str] | None = None
    ) -> None:
        self._custom = dict(custom or {})
        self._frames = FrameTransforms(header.urdf, header.joint_names)
        self._borrowed = isinstance(directory, RunDirectory)
        self._place = directory if isinstance(directory, RunDirectory) else RunDirectory(Path(directory))
        self.path = self._place.bag
        self._written = Written(counts={topic.name: 0 for topic in channels_of(header)})
        self._rows = Rows(_NAMES, _IDS, self._written.counts, str(self.path))
        self._stream: IO[bytes] | None = None
        with self._guarded():
            self._place.clear()
            self._stream = self._place.create(self.path.name, buffering=0)
            self._watched = WatchedFile(self.path, self._stream)
        self._append(0, preamble(header), None)

    def write_description(self, urdf: str) -> None:
        """Write ``robot_description`` and ``/tf_static`` at stamp 0, before the first tick."""
        if self._written.ticks or self._written.counts[ROBOT_DESCRIPTION.name]:
            raise LogError("the description is the first message and the only one of its kind", key=str(self.path))
        messages = {ROBOT_DESCRIPTION: encode_string(urdf)}
        if self._frames.static is not None:
            messages[TF_STATIC] = self._frames.static
        self._rows.count([topic.name for topic in messages])
        records = [message_bytes(CHANNELS[topic.name], 0, 0, data) for topic, data in messages.items()]
        shape = Shape([(CHANNELS[topic.name], len(data)) for topic, data in messages.items()])
        self._append(0, b"".join(records), shape)

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
        self._check_order(stamp)
        derived = [self._frames.from_messages(row[_BASE], row[_JOINTS])]
        derived += [angles.of(row[source]) for angles, source in _ANGLES]
        row = [*row, *derived]
        form = self._rows.form(sizes_of(row))
        self._write(stamp, self._rows.records(stamp, row, form), form.shape)

    def write_block(self, block: TickBlock, tick: Tick) -> bool:
        """Write a tick that fits a block, with the bytes of ``write_row``; False: its topics have not kept step."""
        counts = self._written.counts
        sequences = [counts[name] for name in block.names]
        sequence = sequences[0]
        if sequences.count(sequence) < len(sequences):
            return False
        self._check_order(tick.stamp)
        poses = tick.sample.state.q, tick.reference.q
        derived = [self._frames.of(tick.sample.state)]
        derived += [angles.at(tick.stamp, q[3:7]) for (angles, _), q in zip(_ANGLES, poses, strict=True)]
        sizes = sizes_of(derived)
        form, behind = self._rows.form(block.sizes + sizes), self._rows.form(_NO_MESSAGES + sizes)
        records = block.records(tick, sequence)
        self._rows.count(block.names)
        records += self._rows.records(tick.stamp, [None] * len(LOGGED) + derived, behind)
        self._write(tick.stamp, records, form.shape)
        return True

    def close(self, reason: str) -> None:
        """Write the reason of the end, index the file and write ``metadata.yaml``; later calls do nothing.

        Raises:
            LogError: the disk refuses; the plain file stays, and its reason says what the disk refused.
        """
        if self._stream is None:
            return
        with self._guarded():
            try:
                self._watched.check()
                finish_bag(self._place, self._stream, self._written, reason, self._custom)
            except OSError:
                raise
            except BaseException:
                # A signal ended the process while it was indexed: the plain file has the reason already.
                self._release()
                raise
        self._release()

    def _check_order(self, stamp: int) -> None:
        if stamp <= self._written.last:
            raise LogError(
                "time does not go on", key=str(self.path), value=stamp, accepted=f"more than {self._written.last} ns"
            )

    def _write(self, stamp: int, records: bytes, shape: Shape) -> None:
        """Append the records of a tick."""
        self._append(stamp, records, shape)
        self._written.last = stamp
        self._written.ticks += 1

    def _append(self, stamp: int, data: bytes, shape: Shape | None) -> None:
        """Append records: of messages of one stamp [ns], or None: others."""
        if self._stream is None:
            raise LogError("the log is closed", key=str(self.path))
        try:
            write_all(self._stream, data)
            self._watched.check()
        except OSError as error:
            raise self._refused(error) from None
        if shape is not None:
            self._written.positions.add(self._written.size, stamp, shape)
        self._written.size += len(data)

    @contextmanager
    def _guarded(self) -> Iterator[None]:
        """Whatever the disk refuses becomes one LogError; the log is then closed for good."""
        try:
            yield
        except OSError as error:
            raise self._refused(error) from None

    def _refused(self, error: OSError) -> OSError:
        """Close the log for good, with the reason in it where that still fits; returns the error to raise."""
        refusal = error
        if not isinstance(error, LogError):
            refusal = LogError(f"the log cannot be written: {error.strerror or error}", key=str(self.path))
        if self._stream is not None and self._written.size:
            with suppress(OSError):
                append_end(self._stream, self._written, f"recorder: {refusal}")
        self._release()
        return refusal

    def _release(self) -> None:
        stream, self._stream = self._stream, None
        if stream is not None:
            with suppress(OSError):
                stream.close()
        if not self._borrowed:
            self._place.close()


class LogSink:
    """A Sink that writes values to a log.

    Args:
        directory: run directory, see LogWriter.
        header: provenance; its URDF is also the first message.
        custom: remarks for ``metadata.yaml``.
    """

    def __init__(
        self, directory: StrPath | RunDirectory, header: LogHeader, *, custom: Mapping[str, str] | None = None
    ) -> None:
        self._codec = TickCodec(header.joint_names)
        self._block: TickBlock | None = None
        self.writer = LogWriter(directory, header, custom=custom)
        self.writer.write_description(header.urdf)

    def record(self, tick: Tick) -> None:
        """Write one tick; it is in the file when this returns."""
        block = self._block
        if block is not None and block.fits(tick):
            if self.writer.write_block(block, tick):
                return
        elif ordinary(tick):
            # From the next one on; the labels of telemetry rarely change.
            self._block = TickBlock(self._codec, tick)
        self.writer.write_row(tick.stamp, self._codec.encode(tick))

    def record_unanswered(
        self, sample: PlantSample, reference: Reference, supervision: Supervision | None = None
    ) -> None:
        """Write the last state of a run whose controller had no answer; it is no complete tick."""
        self.writer.write_row(sample.state.stamp, self._codec.encode_unanswered(sample, reference, supervision))

    def close(self, reason: str) -> None:
        """Close the log; later calls do nothing."""
        self.writer.close(reason)


class MemorySink:
    """A Sink that keeps the ticks.

    Attributes:
        ticks: all ticks so far.
        unanswered: state, reference and supervision that the controller had no answer to, if there were any.
        end_reason: None until closed.
    """

    def __init__(self) -> None:
        self.ticks: list[Tick] = []
        self.unanswered: tuple[PlantSample, Reference, Supervision | None] | None = None
        self.end_reason: str | None = None

    @property
    def arrays(self) -> LogArrays:
        """The ticks, at least one, as a log of them would give them."""
        return arrays_of(self.ticks)

    def record(self, tick: Tick) -> None:
        """Keep one tick."""
        self.ticks.append(tick)

    def record_unanswered(
        self, sample: PlantSample, reference: Reference, supervision: Supervision | None = None
    ) -> None:
        """Keep what had no answer."""
        self.unanswered = (sample, reference, supervision)

    def close(self, reason: str) -> None:
        """Keep the reason; the first one counts."""
        if self.end_reason is None:
            self.end_reason = reason
