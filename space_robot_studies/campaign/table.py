"""The one table of a campaign: a row per case, the same bytes whatever ran it and in whatever order."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from io import BytesIO
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

FIXED = {
    "index": pa.int64(),
    "run": pa.int64(),
    "seed": pa.int64(),
    "end_reason": pa.string(),
    "completed": pa.bool_(),
    "passed": pa.bool_(),
    "failed": pa.string(),
    "remarks": pa.string(),
    "ticks": pa.int64(),
}


def parquet(rows: Iterable[Mapping[str, Any]], metadata: Mapping[str, str]) -> bytes:
    """A Parquet file.

    Args:
        rows: columns by name, in the order of the rows; what a row does not have is null.
        metadata: of the file: where its numbers come from.
    """
    rows = list(rows)
    names = dict.fromkeys(name for row in rows for name in row)
    arrays = [_column(name, [row.get(name) for row in rows]) for name in names]
    table = pa.Table.from_arrays(arrays, names=list(names)).replace_schema_metadata(dict(metadata))
    out = BytesIO()
    pq.write_table(table, out)
    return out.getvalue()


def _column(name: str, values: Sequence[Any]) -> pa.Array:
    """Typed by the name where that is fixed, else by what all values can be."""
    if name in FIXED:
        return pa.array(values, FIXED[name])
    kinds = {type(value) for value in values if value is not None}
    if kinds <= {float, int}:
        return pa.array(values, pa.int64() if kinds == {int} else pa.float64())
    if kinds == {bool}:
        return pa.array(values, pa.bool_())
    return pa.array([None if value is None else str(value) for value in values], pa.string())
