"""A log of a fixed number of ticks, closed and as a kill leaves it."""

import io

from space_robot_msgs_py.attitude import SOURCES
from space_robot_msgs_py.codec.codecs import LOGGED
from space_robot_msgs_py.log.mcap.records import MAGIC, scan
from space_robot_msgs_py.log.writer import LogSink
from tests.support import values

COUNT = 30
BY_TICK = (*LOGGED, *SOURCES)


def write_log(place):
    """Write a log; return the bytes of its file just before it is closed."""
    sink = LogSink(place, values.HEADER, custom={"mode": "test"})
    for tick in values.run_ticks(COUNT):
        sink.record(tick)
    plain = sink.writer.path.read_bytes()
    sink.close("completed")
    return plain


def records_in(data):
    """(opcode, content) of every record of a file."""
    stream = io.BytesIO(data)
    stream.seek(len(MAGIC))
    return scan(stream, len(data))
