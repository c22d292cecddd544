"""How the processes of a run's nodes start: they are forked, because four interpreters load for five seconds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from space_robot_bringup.modes.forked import ForkedProcess
from space_robot_bringup.modes.nursery import nursery

PROGRAM = "space_robot_bringup.nodes.process"


def start_node(arguments: Sequence[str], environment: Mapping[str, str], descriptors: Sequence[int]) -> ForkedProcess:
    """``python -m space_robot_bringup.nodes.process`` with these arguments, role first, in a session of its own.

    What a law prints there goes to stderr: it is for people, and this process's stdout may be for programs.

    Args:
        arguments: of the node.
        environment: of its process.
        descriptors: open there under the same numbers; no other one of this process is.
    """
    return nursery(PROGRAM).fork(f"{PROGRAM}:forked", *arguments, descriptors=descriptors, environment=environment)
