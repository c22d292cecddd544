"""The primitives of CDR, the bytes of a ROS message: little endian, aligned from the end of a 4-byte header."""

from __future__ import annotations

import struct
from functools import lru_cache

from space_robot_msgs_py.errors import LayoutError
from space_robot_msgs_py.interfaces import NANOSECONDS

ENCAPSULATION = b"\x00\x01\x00\x00"
# The first two bytes of the messages of ROS, of either byte order.
PLAIN_CDR = (b"\x00\x00", b"\x00\x01")
# Other encodings by number, without the bit of the byte order [DDS-XTypes 1.3, table 60].
_ENCAPSULATIONS = {2: "parameter list", 4: "XML", 6: "XCDR2", 8: "delimited XCDR2", 10: "parameter list XCDR2"}
# Fast DDS counts 4 bytes of alignment for each empty float64[], which it then does not write (a JointState has three),
# and may round up: its buffers are that much longer than the message.
MAX_TRAILING = 15
TIME = struct.Struct("<iI")
UINT32 = struct.Struct("<I")
# All messages of a tick have one stamp; references are a few ticks ahead of the others.
KNOWN_STAMPS = 256


@lru_cache(maxsize=KNOWN_STAMPS)
def pack_stamp(stamp: int) -> bytes:
    """A stamp [ns] as builtin_interfaces/Time.

    Raises:
        LayoutError: the stamp is negative or beyond what int32 seconds hold.
    """
    if not 0 <= stamp < NANOSECONDS << 31:
        raise LayoutError("stamp cannot be written", key="stamp", value=stamp, accepted="0 to 2^31 s, in ns")
    return TIME.pack(*divmod(stamp, NANOSECONDS))


def unpack_stamp(raw: bytes, offset: int = 0) -> int:
    """The stamp [ns] at an offset.

    Raises:
        LayoutError: there are no such bytes, the time is negative or its nanoseconds are a second or more.
    """
    try:
        seconds, nanoseconds = TIME.unpack_from(raw, offset)
    except struct.error:
        raise LayoutError("too short for a stamp", value=f"{len(raw)} bytes") from None
    if seconds < 0 or nanoseconds >= NANOSECONDS:
        raise LayoutError("not a time of a run", key="stamp", value=(seconds, nanoseconds), accepted="0 <= ns < 10^9")
    return int(seconds * NANOSECONDS + nanoseconds)


@lru_cache(maxsize=KNOWN_STAMPS)
def stamp_of(time: bytes) -> int:
    """The stamp [ns] that a builtin_interfaces/Time of eight bytes says; see ``unpack_stamp``."""
    return unpack_stamp(time)


def with_stamp(raw: bytes, stamp: int) -> bytes:
    """A message that begins with a Header or a Time, with another stamp [ns].

    Raises:
        LayoutError: see ``pack_stamp``.
    """
    head = len(ENCAPSULATION)
    return raw[:head] + pack_stamp(stamp) + raw[head + TIME.size :]


def check_encapsulation(raw: bytes, key: str) -> None:
    """Refuse bytes that say they are no plain CDR.

    Args:
        raw: a message.
        key: its topic or type, for the error.

    Raises:
        LayoutError: it is another encoding, which is named by its number in DDS-XTypes.
    """
    if bytes(raw[:2]) in PLAIN_CDR or len(raw) < len(ENCAPSULATION):
        return
    number = int.from_bytes(raw[:2], "big")
    name = _ENCAPSULATIONS.get(number & ~1, "unknown")
    accepted = "plain CDR, kind 0x0000 or 0x0001"
    raise LayoutError(f"{name} encoding, not plain CDR", key=key, value=f"kind 0x{number:04x}", accepted=accepted)


def aligned(position: int, alignment: int) -> int:
    """The next multiple of the alignment, counted from the end of the encapsulation header."""
    return position + (len(ENCAPSULATION) - position) % alignment


def read_primitive(raw: bytes, start: int, kind: str) -> tuple[str | int | None, int]:
    """The string or number at that place (None: the message ends before it), and where it ends."""
    if len(raw) < start + 4:
        return None, start
    (number,) = UINT32.unpack_from(raw, start)
    if kind == "uint32":
        return number, start + 4
    if len(raw) < start + 4 + number:
        return None, start
    return raw[start + 4 : start + 4 + number].removesuffix(b"\0").decode(errors="replace"), start + 4 + number
