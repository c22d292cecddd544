"""The ids under which gymnasium makes the shipped experiments."""

from __future__ import annotations

import gymnasium

from space_robot_description.share import shipped

ENTRY_POINT = "space_robot_bringup.public.environment:SpaceRobotEnv"


def env_id(name: str) -> str:
    """``liu2023/fig08`` to ``space_robot/liu2023-fig08-v0``; only one slash is possible."""
    return f"space_robot/{name.replace('/', '-')}-v0"


def register() -> tuple[str, ...]:
    """Make all shipped experiments known to gymnasium and return their ids; once or more."""
    names = {env_id(name): name for name in shipped("experiments")}
    for one, name in names.items():
        if one not in gymnasium.registry:
            gymnasium.register(one, ENTRY_POINT, kwargs={"experiment": name})
    return tuple(names)
