"""Where the modes of a supervisor enter the simulator: brakes that it closes, wheels that it has unloaded."""

from __future__ import annotations

from collections.abc import Callable

from rclpy.subscription import Subscription

from space_robot_msgs_py.codec.supervision import SupervisionCodec
from space_robot_msgs_py.errors import SpaceRobotError
from space_robot_msgs_py.nodes.base import GraphNode
from space_robot_msgs_py.topics import SUPERVISOR_MODE


class ModePort:
    """Takes note of modes, and says what they have the plant do beside the controller.

    Args:
        node: the node to subscribe on.
        on_mode: called when a mode has come.
        lossless: the plant waits for the mode of each state; otherwise the newest one counts.

    Attributes:
        closed: the brakes are closed by the newest mode.
        unloads: thrusters unload the wheels in it.
        readers: its subscriptions.
    """

    def __init__(self, node: GraphNode, on_mode: Callable[[], None], *, lossless: bool) -> None:
        self._node, self._on_mode, self._lossless = node, on_mode, lossless
        self._codec = SupervisionCodec()
        self.restart()
        self.readers: list[Subscription] = [node.listen(SUPERVISOR_MODE, self._take)]

    def restart(self) -> None:
        """A new run: nothing was heard."""
        self._stamp, self.closed, self.unloads = -1, False, False

    def knows(self, stamp: int) -> bool:
        """The plant may run on from the state with this stamp [ns]."""
        return not self._lossless or self._stamp >= stamp

    def _take(self, raw: bytes) -> None:
        try:
            found = self._codec.decode(raw)
        except SpaceRobotError as error:
            self._node.refuse(SUPERVISOR_MODE, error)
            return
        if found.stamp > self._stamp:
            self._stamp, self.closed, self.unloads = found.stamp, found.brakes, found.unload
            self._on_mode()
