"""Brings nodes that wait for it up in order, or takes them down: all are configured before the first is activated.

python -m space_robot_bringup.nodes.lifecycle_manager [--to inactive] [--ros-args -r __ns:=/alpha]
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from time import monotonic
from typing import Any

from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState, GetState
from rclpy.context import Context
from rclpy.node import Node

from space_robot_bringup.modes.context import domain_number, local_context
from space_robot_bringup.modes.graph import MANAGED, make_executor
from space_robot_bringup.nodes.arguments import split_ros_arguments
from space_robot_msgs_py.errors import SilenceError, SpaceRobotError, SpecError

TRY_SECONDS = 5.0
STATES = ("unconfigured", "inactive", "active")
# From the state of that index to the next one, and to the one before.
UP = (Transition.TRANSITION_CONFIGURE, Transition.TRANSITION_ACTIVATE)
DOWN = (None, Transition.TRANSITION_CLEANUP, Transition.TRANSITION_DEACTIVATE)


def main(arguments: Sequence[str] | None = None) -> int:
    """Take all nodes to a state. Returns 0, 1 where one does not get there, 2 on bad input."""
    own, ros = split_ros_arguments(sys.argv[1:] if arguments is None else arguments)
    parser = argparse.ArgumentParser(prog="space_robot_bringup.nodes.lifecycle_manager", description=__doc__)
    parser.add_argument(
        "--nodes",
        nargs="+",
        default=list(MANAGED),
        help="in the order to bring them up; default: controller simulator; a supervisor comes first",
    )
    parser.add_argument("--to", choices=STATES, default="active", help="state to take them to; default active")
    parser.add_argument(
        "--patience", type=float, default=300.0, help="for every node [s]; default 300: its first start compiles"
    )
    options = parser.parse_args(own)
    try:
        domain = domain_number(os.environ.get("ROS_DOMAIN_ID", "0"))
        with local_context(domain, ros) as context:
            Manager(context, options.nodes, options.patience).take_to(options.to)
    except SpecError as error:
        print(f"space-robot manager: {error}", file=sys.stderr)
        return 2
    except (SpaceRobotError, KeyboardInterrupt) as error:
        print(f"space-robot manager: {error}", file=sys.stderr)
        return 1
    return 0


class Manager:
    """Asks nodes for the transitions of their life cycle.

    Args:
        context: where they are.
        names: node names in the order to bring them up; they are taken down in the opposite one.
        patience: how long a node may take to answer [s].
    """

    def __init__(self, context: Context, names: Sequence[str], patience: float) -> None:
        self._node = Node("manager", context=context, enable_rosout=False, start_parameter_services=False)
        self._executor = make_executor(context)
        self._executor.add_node(self._node)
        self._names, self._patience = tuple(names), patience

    def take_to(self, state: str) -> None:
        """Take every node to a state, level by level.

        Raises:
            SilenceError: a node does not answer.
            SpaceRobotError: a node refuses a transition; its own log says why.
        """
        goal = STATES.index(state)
        for level in range(goal):
            for name in self._names:
                self._leave(name, level, UP[level])
        for level in range(len(STATES) - 1, goal, -1):
            for name in reversed(self._names):
                self._leave(name, level, DOWN[level])

    def _leave(self, name: str, level: int, transition: int | None) -> None:
        """Do the transition if the node is on that level."""
        deadline = monotonic() + self._patience
        request = ChangeState.Request(transition=Transition(id=transition))
        while self._state(name, deadline) == STATES[level]:
            answer = self._try(ChangeState, f"{name}/change_state", request)
            if answer is None:
                continue
            if answer.success:
                # Not asked again: what has just been activated may be at the end of a short run, and gone.
                return
            raise SpaceRobotError(f"does not leave the state {STATES[level]}", key=name, accepted="see its log")

    def _state(self, name: str, deadline: float) -> str:
        while monotonic() < deadline:
            answer = self._try(GetState, f"{name}/get_state", GetState.Request())
            if answer is not None:
                return str(answer.current_state.label)
        waited = f"{self._patience:g} s"
        raise SilenceError("does not answer", key=f"{name}/get_state", value=waited, accepted="a node that runs")

    def _try(self, kind: Any, service: str, request: Any) -> Any:
        """The answer; None where none came: a server that has not discovered its client answers into the void."""
        client = self._node.create_client(kind, service)
        patience = min(self._patience, TRY_SECONDS)
        try:
            if not client.wait_for_service(timeout_sec=patience):
                return None
            answer = client.call_async(request)
            self._executor.spin_until_future_complete(answer, timeout_sec=patience)
            return answer.result() if answer.done() else None
        finally:
            self._node.destroy_client(client)


if __name__ == "__main__":
    sys.exit(main())
