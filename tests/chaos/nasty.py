"""What goes wrong with data: unexpected values, trees with something replaced, bytes with something lost."""

from __future__ import annotations

import struct
from copy import deepcopy
from random import Random
from typing import Any

VALUES: tuple[Any, ...] = (
    None,
    True,
    -1,
    0,
    1e308,
    -1e308,
    1e-320,
    float("nan"),
    float("inf"),
    10**30,
    -(2**200),
    2**63,
    "",
    " ",
    "x" * 3000,
    "\x1b[31mred\x07",
    "a\u202eb",
    "$\\frac$",
    "<img src=x onerror=alert(1)>",
    "[/red]",
    "../../../../etc/passwd",
    "/dev/zero",
    "x" * 5000 + "/y",
    "package://no/such",
    "file.py:Class",
    "os:system",
    "nan",
    "1e999",
    "0x10",
    "null",
    "joint1",
    "base_link",
    [],
    {},
    [[]],
    [None] * 20,
    [1e308] * 3,
    {"": ""},
    {"a": {"b": {"c": []}}},
    [0, 0, 0],
    [1, 0],
    {"joint1": float("inf")},
)
TOKENS = (
    "{",
    "}",
    "[",
    "]",
    ":",
    "- ",
    "&a ",
    "*a",
    "<<: ",
    "!!int ",
    "!x ",
    "|\n",
    "'",
    '"',
    "\t",
    "\n",
    "#",
    "%",
    "\0",
    "\u2028",
)
LENGTHS = (0, 1, 255, 2**16, 2**31, 2**32 - 1, 2**63, 2**64 - 1)


def changed_tree(data: Any, random: Random, times: int = 1) -> Any:
    """A copy of plain data in which something was replaced, dropped, doubled or moved."""
    root = {"": deepcopy(data)}
    for _ in range(times):
        places = list(_places(root))
        container, key = random.choice(places[1:] or places)
        other, other_key = random.choice(places[1:] or places)
        match random.randrange(6):
            case 0 if isinstance(container, dict) and key != "":
                del container[key]
            case 1 if isinstance(container, list):
                container.extend(container[:50])
            case 2 if isinstance(container, dict) and key != "":
                container[random.choice(("extra", "", "kind", "law", "x" * 300, 7))] = container[key]
            case 3:
                container[key] = deepcopy(other[other_key])
            case _:
                container[key] = deepcopy(random.choice(VALUES))
    return root[""]


def _places(data: Any) -> Any:
    """Every container with every key of it, the root first."""
    for key in list(data) if isinstance(data, dict) else range(len(data)):
        yield data, key
        if isinstance(data[key], dict | list):
            yield from _places(data[key])


def changed_text(text: str, random: Random) -> str:
    """A text with tokens put in, pieces doubled, dropped or moved, or its end cut off."""
    for _ in range(random.randint(1, 4)):
        at, to = sorted(random.randrange(len(text) + 1) for _ in range(2))
        to = min(to, at + random.choice((1, 5, 60, 2000)))
        match random.randrange(5):
            case 0:
                text = text[:at] + random.choice(TOKENS) * random.choice((1, 1, 3, 500)) + text[at:]
            case 1:
                text = text[:at] + text[to:]
            case 2:
                text = text[:to] + text[at:to] * random.choice((1, 3)) + text[to:]
            case 3:
                text = text[:at] + str(random.choice(VALUES)) + text[to:]
            case _:
                text = text[:at]
    return text


def changed_bytes(data: bytes, random: Random) -> bytes:
    """Bytes with bits turned, pieces dropped, doubled or swapped, a length that is absurd, or their end cut off."""
    out = bytearray(data)
    for _ in range(random.choice((1, 1, 2, 8))):
        if not out:
            break
        at = random.randrange(len(out))
        size = random.choice((1, 4, 30, 400))
        match random.randrange(7):
            case 0:
                out[at] ^= 1 << random.randrange(8)
            case 1:
                out[at : at + size] = random.randbytes(size)
            case 2:
                del out[at : at + size]
            case 3:
                out[at:at] = out[at : at + size]
            case 4:
                out[at : at + 8] = struct.pack("<Q", random.choice(LENGTHS))
            case 5:
                out[at : at + 4] = struct.pack("<I", random.choice(LENGTHS) & 0xFFFFFFFF)
            case _:
                del out[at:]
    return bytes(out)
