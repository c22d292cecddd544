"""``reference: {kind: recorded, log: PATH}``: the desired motion of an earlier run."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from space_robot_msgs_py.errors import SpecError


def with_recorded_log(reference: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """The reference with the numbers of its log in it, so that the resolved experiment needs no log.

    Args:
        reference: the ``reference`` section; anything but a recorded one with ``log`` is returned as it is.
        folder: where a relative path starts.

    Raises:
        SpecError: ``log`` stands beside numbers, or the log holds no complete tick.
        InputFileError: there is no such log.
        LogError: it is not a run log.
    """
    given = dict(reference)
    if given.get("kind") != "recorded" or "log" not in given:
        return given
    path = folder / str(given.pop("log"))
    beside = sorted(given.keys() - {"kind"})
    if beside:
        raise SpecError("stands beside log", key=f"reference.{beside[0]}", accepted="log, or stamps with q, v and a")
    # Here, because the reader of logs takes its time to load, and few experiments name one.
    from space_robot_msgs_py.log.reader import LogReader

    arrays = LogReader(path).arrays()
    if not arrays.stamp.size:
        raise SpecError("no complete tick in it", key="reference.log", value=str(path), accepted="a log of a run")
    rows = {"stamps": arrays.stamp, "q": arrays.q_d, "v": arrays.v_d, "a": arrays.a_d}
    return given | {name: values.tolist() for name, values in rows.items()}
