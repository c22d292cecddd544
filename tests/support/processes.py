"""Processes as the system lists them: whose children they are."""

from __future__ import annotations

from pathlib import Path

from space_robot_bringup.modes.hooks import roles_of


def descendants(pid: int, depth: int | None = None) -> list[int]:
    """The processes below one, nearest first; with ``depth`` 1 its children alone."""
    if depth == 0:
        return []
    children = []
    for entry in Path("/proc").glob("[0-9]*"):
        try:
            fields = (entry / "stat").read_text().rpartition(")")[2].split()
        except OSError:
            continue
        if int(fields[1]) == pid and fields[0] != "Z":
            children.append(int(entry.name))
    deeper = None if depth is None else depth - 1
    return children + [below for child in children for below in descendants(child, deeper)]


def nodes_below(pid: int) -> dict[str, int]:
    """Process ids of the nodes of a run, by role, which the system knows them by."""
    roles, found = roles_of(supervised=True, failover=True), {}
    for child in descendants(pid):
        try:
            name = Path(f"/proc/{child}/comm").read_text().strip()
        except OSError:
            continue
        if name in roles:
            found[name] = child
    return found
