"""Makes a log that was cut readable for every tool: with index and ``metadata.yaml``, and nothing else changed."""

from __future__ import annotations

from pathlib import Path

from space_robot_msgs_py.errors import LogError
from space_robot_msgs_py.log_directory import TEMPORARY, write_metadata_yaml
from space_robot_msgs_py.log_preamble import CHANNELS
from space_robot_msgs_py.log_reader import LogReader
from space_robot_msgs_py.mcap_index import write_indexed

CUT = "cut"


def recover(path: Path | str) -> Path:
    """Index the log of a killed run in its place; that of a closed one stays as good as it is.

    Args:
        path: run directory or .mcap file.

    Returns:
        The .mcap file.

    Raises:
        InputFileError: there is no such log.
        LogError: it is damaged other than by its end, or the disk refuses; the file is then as it was.
    """
    reader = LogReader(path)
    counts, last = dict.fromkeys(CHANNELS, 0), 0
    for name, stamp, _ in reader.messages():
        counts[name] += 1
        last = stamp
    temporary = reader.path.with_name(reader.path.name + TEMPORARY)
    try:
        write_indexed(reader.path, temporary)
        temporary.replace(reader.path)
        write_metadata_yaml(reader.path, counts, last_stamp=last, custom={"end_reason": reader.end_reason or CUT})
    except OSError as error:
        temporary.unlink(missing_ok=True)
        if isinstance(error, LogError):
            raise
        raise LogError(f"the log cannot be recovered: {error.strerror or error}", key=str(reader.path)) from None
    return reader.path
