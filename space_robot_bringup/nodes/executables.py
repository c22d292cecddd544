"""Which part of the project an executable is, under its own name."""

from __future__ import annotations

from typing import Never

from space_robot_bringup.nodes import process
from space_robot_bringup.nodes.arguments import version_of

REPLAYER = "replayer"


def start(name: str, arguments: list[str]) -> Never:
    """Run an executable to its end and leave with its exit code.

    Args:
        name: of the executable.
        arguments: for a node its role and its options.
    """
    if name != REPLAYER:
        process.leave(process.main(arguments, name))
    from space_robot_bringup.nodes import replayer

    if "--version" in arguments:
        print(version_of(REPLAYER))
        process.leave(0)
    process.leave(replayer.main(arguments))
