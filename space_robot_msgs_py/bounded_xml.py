"""XML of third parties: its encoding, no entities, and size and depth are bounded while it is parsed."""

from __future__ import annotations

import codecs
import re
from typing import Any
from xml.etree import ElementTree as ET

from space_robot_msgs_py.errors import InputFileError, SpecError
from space_robot_msgs_py.limits import URDF_BYTES, URDF_DEPTH, URDF_ELEMENTS

_DECLARED = re.compile(rb"""\s*<\?xml\s[^>]{0,200}?\bencoding\s*=\s*["']([A-Za-z][A-Za-z0-9._-]{0,40})["']""")
_MARKS = {
    codecs.BOM_UTF8: "utf-8-sig",
    codecs.BOM_UTF16_LE: "utf-16",
    codecs.BOM_UTF16_BE: "utf-16",
    b"<\x00": "utf-16-le",
    b"\x00<": "utf-16-be",
}
# Python's registry also has codecs that are no encodings of text, such as zlib.
_ENCODING = re.compile(
    r"utf-8|utf-16(-[bl]e)?|ascii|iso8859-\d+|cp\d+|koi8-[rtu]|gb2312|gbk|gb18030|big5|euc_.*|shift_jis"
)


def decode_xml(data: bytes, where: str) -> str:
    """The text of an XML file, in the encoding of its byte order mark or its declaration, else UTF-8.

    Args:
        data: of the file.
        where: names it in errors.

    Raises:
        InputFileError: the bytes are none of that encoding.
        SpecError: the encoding is unknown.
    """
    encoding = next((name for mark, name in _MARKS.items() if data.startswith(mark)), "")
    if not encoding:
        declared = _DECLARED.match(data)
        encoding = declared[1].decode("ascii") if declared else "utf-8"
        if not _is_encoding(encoding):
            accepted = "UTF-8, UTF-16, ISO-8859-1 or another one of XML"
            raise SpecError("unknown encoding", key=where, value=encoding, accepted=accepted)
    try:
        return data.decode(encoding)
    except UnicodeDecodeError as error:
        what = f"cannot be read as {encoding.upper()} text: {error.reason} at byte {error.start}"
        raise InputFileError(what, key=where) from None


def _is_encoding(name: str) -> bool:
    try:
        return _ENCODING.fullmatch(codecs.lookup(name).name) is not None
    except LookupError:
        return False


def parse_xml(text: str, where: str) -> ET.Element:
    """The root element of an XML text.

    A document type is refused: that is where entities are declared, which grow without end or name other files.

    Args:
        text: of a URDF.
        where: names it in errors.

    Raises:
        SpecError: not XML, with a document type, or beyond a limit.
    """
    # In characters: it is more than that in bytes, and expat counts them.
    URDF_BYTES.check(len(text), where)
    try:
        parser = ET.XMLParser(target=_Bounded(where))
        parser.feed(text)
        root: ET.Element = parser.close()
    except (ET.ParseError, ValueError) as error:
        if isinstance(error, SpecError):
            raise
        raise SpecError(f"not valid XML: {error}", key=where) from None
    return root


class _Bounded(ET.TreeBuilder):
    """Counts while it builds."""

    def __init__(self, where: str) -> None:
        super().__init__()
        self._where, self._count, self._level = where, 0, 0

    def start(self, tag: str, attrs: dict[str, str]) -> Any:
        self._count += 1
        self._level += 1
        URDF_ELEMENTS.check(self._count, self._where)
        URDF_DEPTH.check(self._level, self._where)
        return super().start(tag, attrs)

    def end(self, tag: str) -> Any:
        self._level -= 1
        return super().end(tag)

    def doctype(self, name: str, pubid: str | None, system: str | None) -> None:
        del name, pubid, system
        raise SpecError("has a document type", key=self._where, accepted="XML without <!DOCTYPE ...> and entities")
