"""YAML of third parties: its size is bounded before, while and after it is parsed.

An alias is a value of its own for code that walks the data, so aliases are counted written out: 400 bytes of aliases to
aliases would be more values than there are atoms.
"""

from __future__ import annotations

from typing import Any

from yaml import MappingNode, MarkedYAMLError, Node, ScalarNode, SequenceNode, YAMLError
from yaml.reader import ReaderError

from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.limits import INTEGER_BITS, YAML_BYTES, YAML_DEPTH, YAML_NODES, Limit
from space_robot_msgs_py.yaml_nodes import TooLarge, YamlProblem, compose
from space_robot_msgs_py.yaml_values import BOOL, FLOAT, INT, MAP, MERGE, NULL, SEQ, STR, TIMESTAMP, scalar

# What plain data is made of. Dates, sets, binaries and Python's own are no part of any file here.
_SCALARS = frozenset((NULL, BOOL, INT, FLOAT, STR, MERGE))
_ANCHOR = "found duplicate anchor"


def load_yaml(text: str, where: str, limit: Limit = YAML_BYTES) -> Any:
    """Plain data from YAML 1.2 text: mappings, lists, texts, numbers, truth values and nothing.

    Args:
        text: one document.
        where: names it in errors.
        limit: of its size [bytes].

    Raises:
        SpecError: not YAML (with line and column), a key or an anchor twice, an alias to its own parent, a tag of
            another kind, or something is beyond a limit.
    """
    limit.check(len(text), where)
    try:
        node = compose(text)
        if node is None:
            return None
        _Checker().check(node)
        return _Builder().build(node)
    except TooLarge as error:
        raise error.limit.exceeded(where) from None
    except (YAMLError, ValueError) as error:
        raise SpecError(f"not valid YAML{_place(error, text)}: {_what(error)}", key=where) from None


def values_in(data: object) -> int:
    """How many values plain data has as YAML counts them: keys, lists and mappings are some, too."""
    if isinstance(data, dict):
        return 1 + sum(1 + values_in(value) for value in data.values())
    return 1 + sum(map(values_in, data)) if isinstance(data, list | tuple) else 1


def _place(error: Exception, text: str) -> str:
    if isinstance(error, ReaderError):
        before = text[: error.position]
        return f" at line {before.count(chr(10)) + 1}, column {len(before) - before.rfind(chr(10))}"
    mark = (error.problem_mark or error.context_mark) if isinstance(error, MarkedYAMLError) else None
    return f" at line {mark.line + 1}, column {mark.column + 1}" if mark else ""


def _what(error: Exception) -> str:
    if isinstance(error, ReaderError):
        return str(error.reason)
    if isinstance(error, MarkedYAMLError):
        return _ANCHOR if str(error.context).startswith(_ANCHOR) else str(error.problem or error.context)
    return (str(error) or type(error).__name__).splitlines()[0]


class _Checker:
    """Looks at every node once, however often it is named."""

    def __init__(self) -> None:
        self._sizes: dict[int, tuple[int, int]] = {}

    def check(self, node: Node) -> tuple[int, int]:
        """Number of values and of levels of a node with all aliases written out.

        The depth of the recursion is bounded: aliases lead back to what stands before them.
        """
        found = self._sizes.get(id(node))
        if found is not None:
            if not found[0]:
                raise YamlProblem("an alias to what it is part of", node)
            return found
        self._sizes[id(node)] = (0, 0)
        count, depth = 1, 1
        if isinstance(node, ScalarNode):
            _check_scalar(node)
        else:
            for child in _children(node):
                inner = self.check(child)
                count, depth = count + inner[0], max(depth, 1 + inner[1])
                if count > YAML_NODES.most:
                    raise TooLarge(YAML_NODES)
                if depth > YAML_DEPTH.most:
                    raise TooLarge(YAML_DEPTH)
        self._sizes[id(node)] = (count, depth)
        return count, depth


class _Builder:
    """Plain data of nodes that were checked; what is named twice is one object."""

    def __init__(self) -> None:
        self._built: dict[int, Any] = {}

    def build(self, node: Node) -> Any:
        """The data of a node."""
        if isinstance(node, ScalarNode):
            return _value(node)
        if id(node) not in self._built:
            data = self._mapping(node) if isinstance(node, MappingNode) else self._list(node)
            self._built[id(node)] = data
        return self._built[id(node)]

    def _list(self, node: Node) -> list[Any]:
        return [self.build(one) for one in node.value]

    def _mapping(self, node: MappingNode) -> dict[Any, Any]:
        merged: dict[Any, Any] = {}
        own: dict[Any, Any] = {}
        for key, value in node.value:
            if key.tag == MERGE:
                merged = self._merged(value)
            else:
                own[_value(key)] = self.build(value)
        return merged | own

    def _merged(self, node: Node) -> dict[Any, Any]:
        """Of several mappings that are merged the first that has a key counts."""
        merged: dict[Any, Any] = {}
        for one in reversed(node.value if isinstance(node, SequenceNode) else [node]):
            if not isinstance(one, MappingNode):
                raise YamlProblem("only mappings are merged", one)
            merged |= self.build(one)
        return merged


def _children(node: Node) -> list[Node]:
    expected = SEQ if isinstance(node, SequenceNode) else MAP
    if node.tag != expected:
        raise _refused_tag(node)
    if isinstance(node, SequenceNode):
        return list(node.value)
    keys = set()
    for key, _ in node.value:
        if not isinstance(key, ScalarNode):
            raise YamlProblem("a key that is no text or number", key)
        if (key.value, key.tag) in keys:
            raise YamlProblem(f'found duplicate key "{key.value[:80]}"', key)
        keys.add((key.value, key.tag))
    return [part for pair in node.value for part in pair]


def _value(node: ScalarNode) -> Any:
    try:
        return scalar(node.tag, node.value)
    except ValueError as error:
        raise YamlProblem(str(error), node) from None


def _refused_tag(node: Node) -> YamlProblem:
    return YamlProblem(f"the tag {str(node.tag)[:80]!r} is not accepted, only plain data", node)


def _check_scalar(node: ScalarNode) -> None:
    if node.tag == TIMESTAMP:
        raise YamlProblem(f"a date without quotes ({node.value[:40]})", node)
    if node.tag not in _SCALARS:
        raise _refused_tag(node)
    if "\0" in node.value:
        raise YamlProblem("a text with a NUL", node)
    if node.tag == INT and _bits(node.value) > INTEGER_BITS.most:
        raise TooLarge(INTEGER_BITS)


def _bits(text: str) -> int:
    """Of the number in a text, which is not looked at where it is too long to be one; 0 for what is none."""
    if len(text) > 2 * INTEGER_BITS.most:
        return len(text)
    try:
        return int(text.replace("_", ""), 0).bit_length()
    except ValueError:
        return 0
