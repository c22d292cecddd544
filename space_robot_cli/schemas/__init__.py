"""The JSON schemas that ``space-robot schema`` prints, made from the models and shipped: to make one takes a second.

``python -m space_robot_cli.schemas`` makes them again; a test compares them with the models.
"""

from __future__ import annotations

from importlib.resources import files

from space_robot_msgs_py.errors import SpecError

KINDS = ("experiment", "campaign", "paper")


def schema_text(kind: str) -> str:
    """The JSON schema of a kind of file, as text.

    Raises:
        SpecError: there is no such kind.
    """
    if kind not in KINDS:
        raise SpecError("no such kind", key="KIND", value=kind, accepted=", ".join(KINDS))
    return (files(__name__) / f"{kind}.json").read_text(encoding="utf-8")
