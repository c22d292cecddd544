"""YAML that people read: what a run resolves to, and what a campaign was asked for."""

from __future__ import annotations

from collections.abc import Mapping
from io import StringIO
from typing import Any


def dump_yaml(data: Mapping[str, Any]) -> str:
    """Plain data as YAML text for people: a number's list on one line, a text of many lines as a block."""
    # Here, because most commands write none.
    from ruamel.yaml import YAML

    yaml = YAML(pure=True)
    yaml.width = 120
    out = StringIO()
    yaml.dump(_readable(dict(data)), out)
    return out.getvalue()


def _readable(value: Any) -> Any:
    """Texts of many lines (the URDF) as blocks, lists of numbers on one line."""
    from ruamel.yaml.comments import CommentedSeq
    from ruamel.yaml.scalarstring import LiteralScalarString

    if isinstance(value, dict):
        return {key: _readable(item) for key, item in value.items()}
    if isinstance(value, list):
        items = CommentedSeq(_readable(item) for item in value)
        if not any(isinstance(item, dict) for item in value):
            items.fa.set_flow_style()
        return items
    return LiteralScalarString(value) if isinstance(value, str) and "\n" in value else value
