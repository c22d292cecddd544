"""YAML text as nodes, by libyaml: a twentieth of the time of a parser in Python, and bounded while it composes."""

from __future__ import annotations

from typing import Any

from yaml import MarkedYAMLError, Node, ScalarNode, SequenceNode
from yaml.cyaml import CParser  # type: ignore[attr-defined]

from space_robot_msgs_py.limits import YAML_DEPTH, YAML_NODES, Limit
from space_robot_msgs_py.yaml_values import MAP, SEQ, STR, tag_of_plain


class TooLarge(Exception):
    """Something is beyond a limit."""

    def __init__(self, limit: Limit) -> None:
        super().__init__(limit.name)
        self.limit = limit


class YamlProblem(MarkedYAMLError):
    """Something at a certain place that is YAML, but nothing to be read here."""

    def __init__(self, what: str, node: Node) -> None:
        super().__init__(None, None, what, node.start_mark)


class _Composer(CParser):
    """Asked by libyaml's composer around and at every node, it counts: no more is ever held than may be."""

    def __init__(self, text: str) -> None:
        super().__init__(text)
        self._count = self._level = 0

    def descend_resolver(self, parent: Any, index: Any) -> None:
        """A node that is no alias begins."""
        self._level += 1
        self._count += 1
        if self._count > YAML_NODES.most:
            raise TooLarge(YAML_NODES)
        if self._level > YAML_DEPTH.most:
            raise TooLarge(YAML_DEPTH)

    def ascend_resolver(self) -> None:
        """It ends."""
        self._level -= 1

    def resolve(self, kind: type[Node], value: Any, implicit: Any) -> str:
        """The tag of a node that has none."""
        if kind is ScalarNode:
            return tag_of_plain(value) if implicit[0] else STR
        return SEQ if kind is SequenceNode else MAP


def compose(text: str) -> Node | None:
    """The only document in a text; None where there is none.

    Raises:
        yaml.YAMLError: no YAML.
        TooLarge: more nodes or levels than are accepted.
    """
    composer = _Composer(text)
    try:
        return composer.get_single_node()
    except MarkedYAMLError as error:
        # It reads ahead, and has a bound of its own.
        if "nesting depth" in str(error.problem):
            raise TooLarge(YAML_DEPTH) from None
        raise
    finally:
        composer.dispose()
