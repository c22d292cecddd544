"""The manager and nodes that do not outlive what it asks of them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from threading import Event, Thread
from typing import Any

import pytest

pytest.importorskip("rclpy")
from lifecycle_msgs.msg import State
from lifecycle_msgs.srv import ChangeState, GetState
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from space_robot_bringup.modes.context import private_context
from space_robot_bringup.nodes.lifecycle_manager import Manager

pytestmark = [pytest.mark.ros, pytest.mark.xdist_group("graph")]


@contextmanager
def short_lived(context: Context, name: str) -> Iterator[list[int]]:
    """An inactive node that is gone once it has said that it is active; gives the transitions it was asked for."""
    node, gone, asked = Node(name, context=context), Event(), list[int]()

    def state(_: Any, response: Any) -> Any:
        response.current_state = State(label="inactive")
        return response

    def change(request: Any, response: Any) -> Any:
        asked.append(request.transition.id)
        response.success = True
        gone.set()
        return response

    node.create_service(GetState, f"{name}/get_state", state)
    node.create_service(ChangeState, f"{name}/change_state", change)

    def live() -> None:
        executor = SingleThreadedExecutor(context=context)
        executor.add_node(node)
        while not gone.is_set():
            executor.spin_once(timeout_sec=0.05)
        executor.shutdown()
        node.destroy_node()

    thread = Thread(target=live)
    thread.start()
    try:
        yield asked
    finally:
        gone.set()
        thread.join()


def test_a_node_that_ends_right_after_its_activation_was_brought_up() -> None:
    """A short run may be over before the manager could ask again; who said yes is not waited for."""
    with private_context() as context, short_lived(context, "brief") as asked:
        Manager(context, ["brief"], patience=20.0).take_to("active")
        assert len(asked) == 1
