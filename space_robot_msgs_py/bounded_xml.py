"""XML of third parties: no entities, and size and depth are bounded while it is parsed."""

from __future__ import annotations

from typing import Any
from xml.etree import ElementTree as ET

from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.limits import URDF_BYTES, URDF_DEPTH, URDF_ELEMENTS


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
