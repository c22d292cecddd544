"""What the processes of a test do that belong to another network namespace, which is another host to them."""

from __future__ import annotations

import ctypes
import os
from pathlib import Path
from time import monotonic

from tests.integration.forks import run_main

NAMESPACES = Path("/var/run/netns")
CLONE_NEWNET = 0x40000000
# No other exit codes: an error is none of them.
SEEN, NOT_SEEN = 10, 11


def main_on(namespace: str, module: str, *arguments: str) -> object:
    """The ``main`` of a module in a namespace."""
    enter(namespace)
    return run_main(module, arguments)


def look_for_simulator(namespace: str, seconds: float) -> int:
    """Look around until a simulator is seen, at most so many seconds; the exit code says whether it is."""
    enter(namespace)
    from rclpy.node import Node

    from space_robot_bringup.graph import domain_number, local_context

    with local_context(domain_number(os.environ["ROS_DOMAIN_ID"])) as context:
        node, end = Node("scout", context=context), monotonic() + seconds
        while not (seen := "simulator" in node.get_node_names()) and monotonic() < end:
            node.wait_for_node("simulator", 0.1)
        node.destroy_node()
    return SEEN if seen else NOT_SEEN


def enter(namespace: str) -> None:
    """From now on this process is in the namespace."""
    libc = ctypes.CDLL(None, use_errno=True)
    with (NAMESPACES / namespace).open() as file:
        if libc.setns(file.fileno(), CLONE_NEWNET) != 0:
            raise OSError(ctypes.get_errno(), f"cannot enter the network namespace {namespace}")
