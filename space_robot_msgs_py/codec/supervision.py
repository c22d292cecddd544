"""The decision of a supervisor as one diagnostic_msgs/DiagnosticArray; all but its stamp changes with the mode only."""

from __future__ import annotations

from space_robot_msgs_py.codec.cdr import pack_stamp
from space_robot_msgs_py.codec.statuses import decode_statuses, encode_statuses
from space_robot_msgs_py.codec.texts import peek_stamp
from space_robot_msgs_py.errors import LayoutError
from space_robot_msgs_py.events import OK, WARN, DiagnosticEvent
from space_robot_msgs_py.interfaces import Supervision
from space_robot_msgs_py.topics import SUPERVISOR_MODE

NAME = "mode"
KEYS = ("law", "reference", "since", "answer")
# Behind them, in this order, where it is so: otherwise a message says nothing of brakes or wheels.
FLAGS = (("brakes", "closed"), ("wheels", "unload"))
NO_ANSWER = "none"
# Header: representation, then the stamp.
HEAD, BODY = 4, 12
MAX_CACHED = 64

# The last two are the flags.
_Content = tuple[str, str, str, int, int, bool, bool]


class SupervisionCodec:
    """Supervision without its events and housekeeping, which have topics of their own, to and from bytes."""

    def __init__(self) -> None:
        self._encoded: dict[_Content, bytes] = {}
        self._decoded: dict[bytes, _Content] = {}

    def encode(self, value: Supervision) -> bytes:
        """The message of a decision.

        Raises:
            LayoutError: a text holds a NUL.
        """
        age = -1 if value.answer < 0 else value.stamp - value.answer
        content = (value.mode, value.law, value.reference, value.since, age, value.brakes, value.unload)
        whole = self._encoded.get(content)
        if whole is None:
            if len(self._encoded) >= MAX_CACHED:
                self._encoded.clear()
            whole = self._encoded[content] = _message(content)
        return whole[:HEAD] + pack_stamp(value.stamp) + whole[BODY:]

    def decode(self, raw: bytes) -> Supervision:
        """The decision in a message.

        Raises:
            LayoutError: it is none.
        """
        stamp, (mode, law, reference, since, age, brakes, unload) = peek_stamp(raw), self._content(raw)
        answer = -1 if age < 0 else stamp - age
        return Supervision(stamp, mode, law, reference, since, answer, brakes=brakes, unload=unload)

    def canonical(self, raw: bytes) -> bytes:
        """The same message with zero padding and nothing behind it.

        Raises:
            LayoutError: it is no decision.
        """
        return self.encode(self.decode(raw))

    def _content(self, raw: bytes) -> _Content:
        body = raw[:HEAD] + raw[BODY:]
        content = self._decoded.get(body)
        if content is None:
            if len(self._decoded) >= MAX_CACHED:
                self._decoded.clear()
            content = self._decoded[body] = _read(raw)
        return content


def _message(content: _Content) -> bytes:
    mode, law, reference, since, age, *flags = content
    level = OK if (law, reference) == ("controller", "follow") else WARN
    texts = (law, reference, str(since), NO_ANSWER if age < 0 else str(age))
    said = [flag for flag, on in zip(FLAGS, flags, strict=True) if on]
    values = (*zip(KEYS, texts, strict=True), *said)
    return encode_statuses([DiagnosticEvent(0, level, NAME, mode, "", values)])


def _read(raw: bytes) -> _Content:
    found = decode_statuses(raw)
    first, last = found[0].values[: len(KEYS)], found[0].values[len(KEYS) :]
    flags = [flag in last for flag in FLAGS]
    values = dict(first) if last == tuple(flag for flag in FLAGS if flag in last) else {}
    since, age = values.get("since", ""), values.get("answer", "")
    if len(found) != 1 or found[0].name != NAME or tuple(values) != KEYS or not since.isdecimal():
        accepted = f"one status {NAME} with {', '.join(KEYS)}"
        raise LayoutError("not a mode", key=SUPERVISOR_MODE.name, value=found[0].name[:40], accepted=accepted)
    if age != NO_ANSWER and not age.isdecimal():
        raise LayoutError("not an age", key=f"{SUPERVISOR_MODE.name}.answer", value=age[:40], accepted="ns or none")
    return (
        found[0].message,
        values["law"],
        values["reference"],
        int(since),
        -1 if age == NO_ANSWER else int(age),
        flags[0],
        flags[1],
    )
