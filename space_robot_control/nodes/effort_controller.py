"""Joint efforts as effort controllers of ros2_control take them, turned into answers to states."""

from __future__ import annotations

from typing import Any

import numpy as np

from space_robot_msgs_py.codec.codecs import CommandCodec, peek_stamp
from space_robot_msgs_py.errors import LayoutError, SpaceRobotError
from space_robot_msgs_py.interfaces import Command, Vector
from space_robot_msgs_py.nodes.base import GraphNode
from space_robot_msgs_py.nodes.sending import publish_all, sending
from space_robot_msgs_py.ros import to_msg
from space_robot_msgs_py.topics import BASE_ODOM, Topic
from space_robot_msgs_py.vectors import vector

COMMANDS = Topic(
    "~/commands",
    "std_msgs/msg/Float64MultiArray",
    "set_point",
    "any node",
    "effort of every joint, in model order [N m or N]",
    recorded=False,
)


class EffortControllerNode(GraphNode):
    """Takes the place of the controller: answers states with the efforts on ``~/commands`` and no force on the base.

    Messages of that topic have no stamp. In lock-step each of them answers the state that waits, or the next one: the
    newest counts. Paced, a state is answered with the newest efforts, however old; before the first ones it is not
    answered, and the plant is in its hold.

    Args:
        joint_names: the robot's joints in model order.
        paced: the clock does not wait for answers.
        name: node name.
        options: see GraphNode.
    """

    def __init__(
        self, joint_names: tuple[str, ...], *, paced: bool = False, name: str = "effort_controller", **options: Any
    ) -> None:
        super().__init__(name, **options)
        self._codec, self._n, self._paced = CommandCodec(joint_names), len(joint_names), paced
        self._command_senders = [sending(self.publisher(topic)) for topic in self._codec.topics]
        self.begin_again()
        self.listen(COMMANDS, self._on_commands)
        self.listen(BASE_ODOM, self._on_state)

    @property
    def begun(self) -> bool:
        """True when a state was heard."""
        return self._waiting is not None or self._said[0] >= 0

    def begin_again(self) -> None:
        """The plant was reset: the first state comes again, and is answered with efforts that come from now on."""
        self._efforts: Vector | None = None
        self._waiting: int | None = None
        self._said: tuple[int, tuple[bytes, ...]] = -1, ()

    def _on_commands(self, raw: bytes) -> None:
        try:
            self._efforts = vector(_numbers(raw), self._n, COMMANDS.name)
        except SpaceRobotError as error:
            self.refuse(COMMANDS, error)
            return
        if not self._paced:
            self._answer()

    def _on_state(self, raw: bytes) -> None:
        try:
            stamp = peek_stamp(raw)
        except LayoutError as error:
            self.refuse(BASE_ODOM, error)
            return
        if stamp == self._said[0]:
            # It waits still: the answer was lost on a node that did not hear this one yet.
            publish_all(self._command_senders, self._said[1])
            return
        self._waiting = stamp
        self._answer()

    def _answer(self) -> None:
        if self._waiting is None or self._efforts is None:
            return
        command = Command(self._waiting, np.zeros(6), self._efforts)
        self._said, self._waiting = (self._waiting, tuple(self._codec.encode(command))), None
        if not self._paced:
            self._efforts = None
        publish_all(self._command_senders, self._said[1])


def _numbers(raw: bytes) -> list[float]:
    try:
        return list(to_msg(COMMANDS, raw).data)
    except Exception as error:
        # Whatever the middleware says of bytes that are no message.
        raise LayoutError(f"not a {COMMANDS.type}: {error}", key=COMMANDS.name) from None
