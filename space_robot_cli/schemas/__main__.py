"""``python -m space_robot_cli.schemas`` writes the shipped schemas again."""

from __future__ import annotations

from pathlib import Path

from space_robot_cli.schemas import KINDS
from space_robot_cli.schemas.made import made_schema

if __name__ == "__main__":
    for kind in KINDS:
        (Path(__file__).parent / f"{kind}.json").write_text(made_schema(kind), encoding="utf-8")
