from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest
from mcap.opcode import Opcode
from mcap.reader import make_reader

from space_robot_bringup.compose.composition import compose
from space_robot_bringup.experiment.experiment import load_experiment
from space_robot_bringup.modes.headless import run_in_memory, write_bag
from space_robot_msgs_py.codec.codecs import LOGGED, TickCodec
from space_robot_msgs_py.errors import InputFileError, LayoutError, LogError, SpaceRobotError
from space_robot_msgs_py.interfaces import NANOSECONDS, Telemetry
from space_robot_msgs_py.log.arrays import LogArrays, arrays_of, stack_telemetry
from space_robot_msgs_py.log.mcap.records import MAGIC, MESSAGE, PREFIX
from space_robot_msgs_py.log.preamble import CHANNELS
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.log.writer import LogSink, LogWriter
from space_robot_msgs_py.topics import JOINT_COMMAND
from tests.support import values
from tests.support.counted_log import BY_TICK, COUNT, records_in


def _attempt(path):
    """All ticks of a file, and None; or no ticks, and the one line that says why."""
    try:
        return list(LogReader(path).ticks()), None
    except SpaceRobotError as error:
        return [], str(error)


def _beginning(ticks):
    """True if these are the first ticks of the run, bit for bit."""
    expected = values.run_ticks(COUNT)[: len(ticks)]
    return [values.bits(tick) for tick in ticks] == [values.bits(tick) for tick in expected]


def test_a_written_log_reads_back_bit_for_bit(run):
    """Header, description, reason and every tick come back bit for bit, from the directory and from the file."""
    for path in (run, run / "run_0.mcap", str(run)):
        reader = LogReader(path)
        assert reader.header == values.HEADER
        assert reader.robot_description == values.HEADER.urdf
        assert reader.end_reason == "completed"
        ticks = list(reader.ticks())
        assert [values.bits(tick) for tick in ticks] == [values.bits(tick) for tick in values.run_ticks(COUNT)]


def test_messages_come_in_table_order(run):
    """The description is first, then every stamp has every topic of a tick in the order of the table."""
    listed = [(name, stamp) for name, stamp, _ in LogReader(run).messages()]
    expected = [(topic.name, k * values.PERIOD) for k in range(COUNT) for topic in BY_TICK]
    assert listed == [("robot_description", 0), *expected]


def test_arrays_are_the_ticks_stacked(run):
    """Every array holds, row by row, the bits of the ticks."""
    reader = LogReader(run)
    arrays, ticks = reader.arrays(), list(reader.ticks())
    assert len(ticks) == COUNT
    assert arrays.time.tolist() == [tick.stamp / NANOSECONDS for tick in ticks]
    for row, tick in enumerate(ticks):
        state, reference, command = tick.sample.state, tick.reference, tick.output.command
        pairs = [
            (arrays.q, state.q), (arrays.v, state.v), (arrays.effort, state.effort),
            (arrays.base_acceleration, state.base_acceleration), (arrays.q_d, reference.q), (arrays.v_d, reference.v),
            (arrays.a_d, reference.a), (arrays.wrench, command.wrench), (arrays.effort_command, command.effort),
            (arrays.wheel_momentum, state.wheel_momentum),
            (arrays.controller["error"], tick.output.telemetry["error"]),
            (arrays.controller["gain"], tick.output.telemetry["gain"]),
            (arrays.plant["energy"], tick.sample.telemetry["energy"]),
        ]  # fmt: skip
        assert all(stacked[row].tobytes() == single.tobytes() for stacked, single in pairs)


@pytest.mark.parametrize("part", range(50))
def test_a_truncated_log_is_read_to_its_last_complete_tick(killed, tmp_path, part):
    """Cut anywhere, a log is read without a traceback, and what is read is the beginning of what was written."""
    cut = len(killed) * part // 50 + part
    path = tmp_path / "cut_0.mcap"
    path.write_bytes(killed[:cut])
    ticks, refusal = _attempt(path)
    assert _beginning(ticks)
    if refusal is not None:
        # Only where not even the header is whole.
        assert "\n" not in refusal
        assert cut < killed.index(b"ros2msg")
        return
    assert len(ticks) == _whole_ticks(killed[:cut])
    assert LogReader(path).end_reason is None
    assert LogReader(path).arrays().q.shape == (len(ticks), 10)


def _whole_ticks(data):
    """How many ticks have all their records in these bytes."""
    numbers = [MESSAGE.unpack_from(content)[0] for opcode, content in records_in(data) if opcode == Opcode.MESSAGE]
    return numbers.count(CHANNELS[LOGGED[-1].name])


@pytest.fixture(scope="module")
def ends(run):
    """Where the chunk with all messages ends, and where the record of the run's end does, as mcap itself finds them."""
    with (run / "run_0.mcap").open("rb") as stream:
        summary = make_reader(stream).get_summary()
    (chunk,) = summary.chunk_indexes
    (end,) = (index for index in summary.metadata_indexes if index.name == "end")
    return chunk.chunk_start_offset + chunk.chunk_length, end.offset + end.length


@pytest.mark.parametrize("part", range(1, 20))
def test_a_truncated_indexed_log_is_read(run, ends, tmp_path, part):
    """A closed log that was truncated later gives every tick if its chunk is whole, else none; its end where it is."""
    data, (messages, end) = (run / "run_0.mcap").read_bytes(), ends
    cut = len(data) * part // 20
    path = tmp_path / "cut_0.mcap"
    path.write_bytes(data[:cut])
    ticks, refusal = _attempt(path)
    assert refusal is None
    assert len(ticks) == (COUNT if cut >= messages else 0)
    assert _beginning(ticks)
    assert LogReader(path).end_reason == ("completed" if cut >= end else None)


@pytest.mark.parametrize("part", range(60))
def test_damage_is_noticed_or_harmless(run, ends, tmp_path, part):
    """With a byte changed a closed log is one clear error, all its ticks, or truncated; behind its ticks it is all."""
    data, (messages, _) = bytearray((run / "run_0.mcap").read_bytes()), ends
    at = len(data) * part // 60
    data[at] ^= 0x10
    path = tmp_path / "damaged_0.mcap"
    path.write_bytes(data)
    ticks, refusal = _attempt(path)
    assert _beginning(ticks)
    whole = refusal is None and len(ticks) == COUNT
    assert whole if at >= messages else whole or refusal or LogReader(path).end_reason is None
    assert "\n" not in (refusal or "")


def test_a_missing_message_is_noticed(killed, tmp_path):
    """A record taken out of the middle is found by its sequence number."""
    records = [PREFIX.pack(opcode, len(content)) + content for opcode, content in records_in(killed)]
    del records[-25]
    path = tmp_path / "gap_0.mcap"
    path.write_bytes(MAGIC + b"".join(records))
    with pytest.raises(LogError, match="a message is missing"):
        list(LogReader(path).ticks())


@pytest.mark.parametrize("content", [b"", b"not mcap at all", b"\x89MCAP0\r\n", b"PK\x03\x04" + bytes(100)])
def test_other_files_are_refused(tmp_path, content):
    """A file that is not MCAP, or is empty, is one line that names it."""
    path = tmp_path / "x.mcap"
    path.write_bytes(content)
    with pytest.raises((InputFileError, LogError), match=r"x\.mcap") as caught:
        LogReader(path)
    assert "\n" not in str(caught.value)


def test_missing_files_and_directories_are_named(tmp_path):
    """No file, a directory without a bag, or with two, is an InputFileError that names the path."""
    with pytest.raises(InputFileError, match="no such file"):
        LogReader(tmp_path / "nothing")
    with pytest.raises(InputFileError, match="0 files"):
        LogReader(tmp_path)
    for name in ("a", "b"):
        (tmp_path / f"{name}_0.mcap").write_bytes(b"")
    with pytest.raises(InputFileError, match="2 files"):
        LogReader(tmp_path)


def test_a_foreign_mcap_file_is_refused(tmp_path):
    """A valid MCAP file of another tool is a LogError, not an empty log."""
    from mcap.writer import Writer

    with (tmp_path / "x.mcap").open("wb") as stream:
        writer = Writer(stream)
        writer.start()
        writer.finish()
    with pytest.raises(LogError, match="not a run log"):
        LogReader(tmp_path / "x.mcap")


def test_telemetry_that_changes_shape_is_named(tmp_path):
    """Arrays need telemetry of one shape; the error says which topic changes."""
    first, second = values.run_ticks(2)
    sink = LogSink(tmp_path / "run", values.HEADER)
    sink.record(first)
    sink.record(replace(second, sample=replace(second.sample, telemetry=_more(second))))
    sink.close("completed")
    assert len(list(LogReader(tmp_path / "run").ticks())) == 2
    with pytest.raises(LogError, match=r"plant/telemetry"):
        LogReader(tmp_path / "run").arrays()


@pytest.mark.parametrize("fault", ["wrong names", "not a number"])
def test_a_tick_with_a_refused_command_is_distinguished(tmp_path, fault):
    """A command that does not fit stays in the log as a message, is named, and spoils no other tick."""
    codec, ticks = TickCodec(values.NAMES), values.run_ticks(5)
    writer = LogWriter(tmp_path / "run", values.HEADER)
    for index, tick in enumerate(ticks):
        parts = dict(zip(LOGGED, codec.encode(tick), strict=True))
        if index == 2:
            raw = parts[JOINT_COMMAND]
            nan = np.array([np.nan]).tobytes()
            parts[JOINT_COMMAND] = raw.replace(b"elbow", b"ankle") if fault == "wrong names" else raw[:-8] + nan
        writer.write_tick(tick.stamp, parts)
    writer.close("completed")
    reader, kept = LogReader(tmp_path / "run"), [*ticks[:2], *ticks[3:]]
    assert [values.bits(tick) for tick in reader.ticks()] == [values.bits(tick) for tick in kept]
    assert reader.arrays().stamp.tolist() == [tick.stamp for tick in kept]
    (line,) = reader.unfit()
    assert line.startswith(f"{ticks[2].stamp} ns: ")
    assert ("joint_command" if fault == "wrong names" else "command.effort") in line
    assert sum(name == JOINT_COMMAND.name for name, _, _ in reader.messages()) == 5


def _more(tick):
    telemetry = tick.sample.telemetry
    return type(telemetry).of(tick.stamp, {"energy": 1.0, "momentum": np.zeros(3)})


def test_ticks_in_memory_stack_like_a_log_of_them(tmp_path: Path) -> None:
    """``arrays_of`` gives the arrays that the log of the same ticks gives, bit for bit."""
    composition = compose(load_experiment("liu2023/fig08", ("duration=1.0",)))
    sink = run_in_memory(composition)
    write_bag(sink, composition, tmp_path / "run")
    logged, stacked = LogReader(tmp_path / "run").arrays(), arrays_of(sink.ticks)
    for field in fields(LogArrays):
        ours, theirs = getattr(stacked, field.name), getattr(logged, field.name)
        pairs = [(ours[label], theirs[label]) for label in theirs] if isinstance(theirs, dict) else [(ours, theirs)]
        for a, b in pairs:
            np.testing.assert_array_equal(a, b)


def test_telemetry_that_changes_within_a_run_is_refused():
    """Another layout at one tick, or a block that is not there, is one clear error and no array of something else."""
    first = Telemetry.of(0, {"a": [1.0, 2.0], "b": 3.0})
    assert stack_telemetry([first, Telemetry.of(1, {"a": [4.0, 5.0], "b": 6.0})])["a"].tolist() == [[1, 2], [4, 5]]
    for other in ({"a": [1.0, 2.0], "c": 3.0}, {"a": 1.0, "b": [2.0, 3.0]}, {"a": [1.0, 2.0]}):
        with pytest.raises(LayoutError, match="change"):
            stack_telemetry([first, Telemetry.of(1, other)])
    with pytest.raises(LayoutError, match="z"):
        stack_telemetry([first], ("a", "z"))
