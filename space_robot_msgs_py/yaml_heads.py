"""What a YAML file says at its top, read no further than that: a manifest of a thousand lines begins with its title."""

from __future__ import annotations

from collections.abc import Collection

from yaml import MappingEndEvent, MappingStartEvent, ScalarEvent, SequenceEndEvent, SequenceStartEvent, YAMLError
from yaml.cyaml import CParser  # type: ignore[attr-defined]

from space_robot_msgs_py.errors import SpecError


def top_texts(text: str, wanted: Collection[str], where: str) -> dict[str, str]:
    """The scalars of some keys of the mapping that a text is, as they are written; keys it has not are left out.

    Args:
        text: one document. Behind the last of the keys it is not looked at.
        wanted: keys.
        where: names it in errors.

    Raises:
        SpecError: it is no YAML as far as it was read.
    """
    parser = CParser(text)
    try:
        return _read(parser, wanted)
    except YAMLError as error:
        raise SpecError(f"not valid YAML: {str(error).splitlines()[0]}", key=where) from None
    finally:
        parser.dispose()


def _read(parser: CParser, wanted: Collection[str]) -> dict[str, str]:
    found: dict[str, str] = {}
    depth, key = 0, None
    while len(found) < len(wanted) and (event := parser.get_event()) is not None:
        if isinstance(event, MappingStartEvent | SequenceStartEvent):
            if not depth and isinstance(event, SequenceStartEvent):
                break
            depth += 1
        elif isinstance(event, MappingEndEvent | SequenceEndEvent):
            depth -= 1
            key = None if depth == 1 else key
        elif depth == 1 and isinstance(event, ScalarEvent):
            if key is None:
                key = event.value
                continue
            if key in wanted:
                found[key] = event.value
            key = None
        elif depth == 1:
            # An alias is a value, too.
            key = None
    return found
