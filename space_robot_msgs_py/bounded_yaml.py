"""YAML of third parties: its size is bounded before, while and after it is parsed.

An alias is a value of its own for code that walks the data, so aliases are counted written out: 400 bytes of aliases to
aliases would be more values than there are atoms.
"""

from __future__ import annotations

import warnings
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.composer import Composer
from ruamel.yaml.error import MarkedYAMLError, ReusedAnchorWarning, YAMLError
from ruamel.yaml.nodes import MappingNode, ScalarNode, SequenceNode

from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.limits import INTEGER_BITS, YAML_BYTES, YAML_DEPTH, YAML_NODES, Limit

# What plain data is made of. Dates, sets, binaries and Python's own are no part of any file here.
_KINDS = ("null", "bool", "int", "float", "str", "seq", "map", "merge")
_TAGS = frozenset(f"tag:yaml.org,2002:{kind}" for kind in _KINDS)
_TIMESTAMP = "tag:yaml.org,2002:timestamp"


def load_yaml(text: str, where: str, limit: Limit = YAML_BYTES) -> Any:
    """Plain data from YAML 1.2 text: mappings, lists, texts, numbers, truth values and nothing.

    Args:
        text: one document.
        where: names it in errors.
        limit: of its size [bytes].

    Raises:
        SpecError: not YAML (with line and column), a key twice, an alias to its own parent, a tag of another kind, or
            something is beyond a limit.
    """
    limit.check(len(text), where)
    yaml = YAML(typ="safe", pure=True)
    yaml.Composer = _Bounded
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ReusedAnchorWarning)
            data = yaml.load(text)
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        place = f" at line {mark.line + 1}, column {mark.column + 1}" if mark else ""
        # ruamel appends advice on how to switch the check off; the first line is the problem.
        problem = str(error.problem or error.context or "syntax error").strip().splitlines()[0]
        raise SpecError(f"not valid YAML{place}: {problem}", key=where) from None
    except _TooLarge as error:
        raise error.limit.exceeded(where) from None
    except (YAMLError, ValueError, RecursionError, AttributeError, TypeError, LookupError, AssertionError) as error:
        # The last four: what ruamel makes of some texts that are no YAML.
        raise SpecError(f"not valid YAML: {(str(error) or type(error).__name__).splitlines()[0]}", key=where) from None
    return data


def values_in(data: object) -> int:
    """How many values plain data has as YAML counts them: keys, lists and mappings are some, too."""
    if isinstance(data, dict):
        return 1 + sum(1 + values_in(value) for value in data.values())
    return 1 + sum(map(values_in, data)) if isinstance(data, list | tuple) else 1


class _TooLarge(Exception):
    """Something is beyond a limit."""

    def __init__(self, limit: Limit) -> None:
        super().__init__(limit.name)
        self.limit = limit


class _Bounded(Composer):
    """Counts while it composes, so that no more is ever held than may be."""

    def __init__(self, loader: Any = None) -> None:
        super().__init__(loader=loader)
        self._count = self._level = 0

    def compose_node(self, parent: Any, index: Any) -> Any:
        self._count += 1
        self._level += 1
        if self._count > YAML_NODES.most:
            raise _TooLarge(YAML_NODES)
        if self._level > YAML_DEPTH.most:
            raise _TooLarge(YAML_DEPTH)
        node = super().compose_node(parent, index)
        self._level -= 1
        return node

    def get_single_node(self) -> Any:
        node = super().get_single_node()
        if node is not None:
            _Checker().check(node)
        return node


class _Checker:
    """Looks at every node once, however often it is named."""

    def __init__(self) -> None:
        self._sizes: dict[int, tuple[int, int]] = {}

    def check(self, node: Any) -> tuple[int, int]:
        """Number of values and of levels of a node with all aliases written out.

        The depth of the recursion is bounded: aliases lead back to what stands before them.
        """
        found = self._sizes.get(id(node))
        if found is not None:
            if not found[0]:
                raise _problem("an alias to what it is part of", node)
            return found
        self._sizes[id(node)] = (0, 0)
        count, depth = 1, 1
        if isinstance(node, ScalarNode):
            _check_scalar(node)
        else:
            for child in self._children(node):
                inner = self.check(child)
                count, depth = count + inner[0], max(depth, 1 + inner[1])
                if count > YAML_NODES.most:
                    raise _TooLarge(YAML_NODES)
                if depth > YAML_DEPTH.most:
                    raise _TooLarge(YAML_DEPTH)
        self._sizes[id(node)] = (count, depth)
        return count, depth

    def _children(self, node: Any) -> list[Any]:
        _check_tag(node)
        if isinstance(node, SequenceNode):
            return list(node.value)
        assert isinstance(node, MappingNode)
        # ruamel looks for keys that come twice only where nothing is merged.
        keys = set()
        for key, _ in node.value:
            if not isinstance(key, ScalarNode):
                raise _problem("a key that is no text or number", key)
            if (key.value, _tag(key)) in keys:
                raise _problem(f'found duplicate key "{key.value[:80]}"', key)
            keys.add((key.value, _tag(key)))
        return [part for pair in node.value for part in pair]


def _tag(node: Any) -> str:
    return str(node.tag or "")


def _check_tag(node: Any) -> None:
    if _tag(node) not in _TAGS:
        raise _problem(f"the tag {_tag(node)[:80]!r} is not accepted, only plain data", node)


def _check_scalar(node: Any) -> None:
    if _tag(node) == _TIMESTAMP:
        raise _problem(f"a date without quotes ({node.value[:40]})", node)
    _check_tag(node)
    if "\0" in node.value:
        raise _problem("a text with a NUL", node)
    if _tag(node).endswith(":int") and _bits(node.value) > INTEGER_BITS.most:
        raise _TooLarge(INTEGER_BITS)


def _bits(text: str) -> int:
    """Of the number in a text, which is not looked at where it is too long to be one; 0 for what is none."""
    if len(text) > 2 * INTEGER_BITS.most:
        return len(text)
    try:
        return int(text.replace("_", ""), 0).bit_length()
    except ValueError:
        return 0


def _problem(what: str, node: Any) -> MarkedYAMLError:
    return MarkedYAMLError(None, None, what, node.start_mark)
