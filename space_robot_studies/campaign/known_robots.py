"""Robots that a study makes once: hundreds of its runs have the same one."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import lru_cache
from typing import Any

from space_robot_description.frozen import plain
from space_robot_description.load import load_robot
from space_robot_description.robot import Robot


def known_content(robot: str | Mapping[str, Any]) -> Robot:
    """A robot, made once where its content is given; files, which may change between studies, are read every time."""
    return load_robot(robot) if isinstance(robot, str) else _made(json.dumps(plain(robot)), False)


def known_robot(robot: str | Mapping[str, Any]) -> Robot:
    """A robot by its name or its content, made once: a worker runs one study, whose files do not change."""
    return _made(robot if isinstance(robot, str) else json.dumps(plain(robot)), isinstance(robot, str))


@lru_cache(maxsize=32)
def _made(text: str, named: bool) -> Robot:
    return load_robot(text if named else json.loads(text))
