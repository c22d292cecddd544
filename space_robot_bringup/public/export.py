"""`space_robot.export`: a log as one table for tools that read CSV or Parquet, a row per tick."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Any

import numpy as np

from space_robot_bringup.public.arrays import RunArrays, run_arrays
from space_robot_bringup.public.calls import for_python, needing
from space_robot_bringup.public.units import column_units
from space_robot_msgs_py.errors import LogError, SpecError
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.paths import StrPath

# Written under this name and renamed at the end: a table that is there is whole.
PARTIAL = ".part"


@for_python
def export(log: StrPath, out: StrPath, *, overwrite: bool = False) -> Path:
    """Write a log as a table: time, stamp, then every number of ``RunArrays.columns`` under its name.

    A log of any length is read in blocks. Numbers in CSV are read back to the same bits; Parquet has the unit of a
    column in the metadata of its field.

    Args:
        log: a run, run directory or .mcap file.
        out: the table; ``.csv`` or ``.parquet`` decides what it is.
        overwrite: a file that is there is replaced.

    Returns:
        Where the table is.

    Raises:
        InputFileError: there is no such log.
        SpecError: another suffix, a file that is there, or Parquet without pyarrow.
        LogError: the log has no complete tick, or the table cannot be written.
    """
    return write_table(log, Path(out), overwrite=overwrite)


def write_table(log: StrPath, place: Path, *, overwrite: bool = False) -> Path:
    """``export``, with errors that name the options of the command line."""
    reader = LogReader(log)
    if place.suffix not in WRITERS:
        accepted = "a name that ends in .csv or .parquet"
        raise SpecError("not a format of tables", key="--out", value=str(place), accepted=accepted)
    if place.exists() and not overwrite:
        raise SpecError("is there already", key="--out", value=str(place), accepted="--overwrite, or another name")
    partial = place.with_name(place.name + PARTIAL)
    try:
        WRITERS[place.suffix](reader, partial)
        partial.replace(place)
    except OSError as error:
        raise LogError(f"cannot be written: {error.strerror or error}", key=str(place)) from None
    finally:
        with suppress(OSError):
            partial.unlink(missing_ok=True)
    return place


def _write_csv(log: LogReader, place: Path) -> None:
    head: list[str] = []
    with place.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        for table in map(_table, _blocks(log)):
            if not head:
                head = [*table]
                writer.writerow(head)
            # Python's own numbers: the shortest text that is read back to the same bits.
            writer.writerows(zip(*(column.tolist() for column in table.values()), strict=True))


def _write_parquet(log: LogReader, place: Path) -> None:
    with needing("a Parquet file", "campaign"):
        import pyarrow as pa
        import pyarrow.parquet as pq
    schema = None
    with ExitStack() as stack:
        for arrays in _blocks(log):
            table = _table(arrays)
            if schema is None:
                units = column_units(arrays, log.header)
                fields = [pa.field(name, pa.from_numpy_dtype(value.dtype)) for name, value in table.items()]
                schema = pa.schema([field.with_metadata({"unit": units.get(field.name, "")}) for field in fields])
                writer = stack.enter_context(pq.ParquetWriter(place, schema))
            columns = [pa.array(np.ascontiguousarray(value)) for value in table.values()]
            writer.write_table(pa.Table.from_arrays(columns, schema=schema))


def _blocks(log: LogReader) -> Iterator[RunArrays]:
    """The log in blocks of ticks.

    Raises:
        LogError: there is none.
    """
    empty = True
    for block in log.blocks():
        yield run_arrays(block, log.header.joint_names)
        empty = False
    if empty:
        raise LogError("nothing to export: no complete tick", key=str(log.path))


def _table(arrays: RunArrays) -> dict[str, np.ndarray[Any, Any]]:
    return {"time": arrays.time, "stamp": arrays.stamp, **dict(arrays.columns())}


WRITERS = {".csv": _write_csv, ".parquet": _write_parquet}
