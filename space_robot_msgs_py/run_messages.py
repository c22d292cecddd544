"""What the nodes of a run say of the run itself: that it begins (again), and why it ends. One JSON object each.

Both quote the run, a name that only its simulator gives, so that a message of another run, or of no run, ends nothing.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from typing import Any

from space_robot_msgs_py.codec.texts import decode_string, encode_string
from space_robot_msgs_py.errors import LayoutError
from space_robot_msgs_py.limits import REASON_BYTES
from space_robot_msgs_py.topics import RUN_BEGIN, RUN_END, Topic


@dataclass(frozen=True, slots=True)
class RunBegin:
    """A run begins at stamp 0.

    Attributes:
        run: name of the run, the same until its simulator is gone.
        number: how often it was reset; 0 at first.
    """

    run: str
    number: int


@dataclass(frozen=True, slots=True)
class RunEnd:
    """A run is over.

    Attributes:
        run: its name; empty where the sender knows of none yet.
        node: full name of the sender.
        reason: why.
    """

    run: str
    node: str
    reason: str


def encode_begin(begin: RunBegin) -> bytes:
    """The std_msgs/String of ``run_begin``."""
    return encode_string(json.dumps(asdict(begin)))


def decode_begin(raw: bytes) -> RunBegin:
    """Inverse of ``encode_begin``.

    Raises:
        LayoutError: the bytes are no such message.
    """
    fields = _fields(raw, RUN_BEGIN, {"run": str, "number": int})
    if not fields["run"] or fields["number"] < 0:
        raise LayoutError("not the begin of a run", key=RUN_BEGIN.name, value=fields, accepted="a name, 0 or more")
    return RunBegin(**fields)


def encode_end(end: RunEnd) -> bytes:
    """The std_msgs/String of ``run_end``."""
    return encode_string(json.dumps(asdict(end), ensure_ascii=False))


def decode_end(raw: bytes) -> RunEnd:
    """Inverse of ``encode_end``.

    Raises:
        LayoutError: the bytes are no such message.
    """
    return RunEnd(**_fields(raw, RUN_END, {"run": str, "node": str, "reason": str}))


def _fields(raw: bytes, topic: Topic, types: dict[str, type]) -> dict[str, Any]:
    text = decode_string(raw, REASON_BYTES)
    accepted = "a JSON object with " + ", ".join(types)
    try:
        found = json.loads(text)
    except (ValueError, RecursionError):
        raise LayoutError("not of a run", key=topic.name, value=text[:80], accepted=accepted) from None
    if not isinstance(found, dict) or any(type(found.get(name)) is not kind for name, kind in types.items()):
        raise LayoutError("not of a run", key=topic.name, value=text[:80], accepted=accepted)
    return {name: found[name] for name in types}
