"""What the scalars of YAML 1.2 mean: plain ones by their looks, tagged ones by their tag."""

from __future__ import annotations

import re
from math import inf, nan
from typing import Any

TAG = "tag:yaml.org,2002:"
NULL, BOOL, INT, FLOAT, STR = (TAG + kind for kind in ("null", "bool", "int", "float", "str"))
SEQ, MAP, MERGE, TIMESTAMP, VALUE = (TAG + kind for kind in ("seq", "map", "merge", "timestamp", "value"))

_TRUE, _FALSE = ("true", "True", "TRUE"), ("false", "False", "FALSE")
# Of what is no number; numbers are known by their form.
_WORDS = {
    **dict.fromkeys(("", "~", "null", "Null", "NULL"), NULL),
    **dict.fromkeys((*_TRUE, *_FALSE), BOOL),
    "<<": MERGE,
    "=": VALUE,
}
_BASES = {"0b": 2, "0o": 8, "0x": 16}
# Underscores between digits are no YAML 1.2, but people write them, and nothing else can be meant.
_FORMS = (
    (
        FLOAT,
        re.compile(
            r"[-+]?[0-9][0-9_]*(\.[0-9_]*([eE][-+]?[0-9]+)?|[eE][-+]?[0-9]+)"
            r"|[-+]?\.[0-9][0-9_]*([eE][-+]?[0-9]+)?|[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)"
        ),
    ),
    (INT, re.compile(r"[-+]?([0-9][0-9_]*|0b[01_]+|0o[0-7_]+|0x[0-9a-fA-F_]+)")),
    (
        TIMESTAMP,
        re.compile(
            r"[0-9]{4}-[0-9]{1,2}-[0-9]{1,2}"
            r"(([Tt]|[ \t]+)[0-9]{1,2}:[0-9]{2}:[0-9]{2}(\.[0-9]*)?([ \t]*(Z|[-+][0-9]{1,2}(:[0-9]{2})?))?)?"
        ),
    ),
)
_FIRST_OF_NUMBERS = frozenset("-+.0123456789")


def tag_of_plain(text: str) -> str:
    """The tag of a scalar without quotes and tag."""
    word = _WORDS.get(text)
    if word is not None:
        return word
    if text[0] in _FIRST_OF_NUMBERS:
        for tag, form in _FORMS:
            if form.fullmatch(text):
                return tag
    return STR


def scalar(tag: str, text: str) -> Any:
    """The value of a scalar.

    Raises:
        ValueError: the text is none of that tag.
    """
    if tag == FLOAT:
        return _float(text)
    if tag == INT:
        return _int(text)
    if tag == BOOL:
        if text not in (*_TRUE, *_FALSE):
            raise ValueError(f"{text[:40]!r} is no truth value")
        return text in _TRUE
    return None if tag == NULL else text


def _int(text: str) -> int:
    digits = text.replace("_", "")
    unsigned = digits.lstrip("+-")
    base = _BASES.get(unsigned[:2])
    if base is None:
        return int(digits)
    value = int(unsigned[2:], base)
    return -value if digits.startswith("-") else value


def _float(text: str) -> float:
    digits = text.replace("_", "").lower()
    unsigned = digits.lstrip("+-")
    if unsigned == ".nan":
        return nan
    if unsigned == ".inf":
        return -inf if digits.startswith("-") else inf
    return float(digits)
