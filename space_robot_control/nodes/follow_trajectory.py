"""The action that motion planners such as MoveIt send trajectories to, where its messages are installed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from typing import Any

from rclpy.action import ActionServer, CancelResponse
from rclpy.task import Future

from space_robot_control.nodes.set_point_messages import trajectory_in
from space_robot_control.references.trajectory import Trajectory
from space_robot_msgs_py.errors import SpaceRobotError
from space_robot_msgs_py.nodes.base import GraphNode
from space_robot_msgs_py.set_points import JOINT_TRAJECTORY

NAME = "~/follow_joint_trajectory"
SUCCESSFUL, INVALID_GOAL = 0, -1
REPLACED = "another trajectory took its place"
CANCELLED = "cancelled: the arm stays where it is asked to be"


@dataclass(eq=False, slots=True)
class _Goal:
    """A trajectory that is being followed.

    Attributes:
        end: stamp of its last point [ns].
        outcome: the words for how it ended; empty: it was followed to its end.
    """

    end: int
    outcome: Future


class TrajectoryAction:
    """Offers control_msgs/action/FollowJointTrajectory; without control_msgs it does nothing.

    A goal that cannot be followed is aborted with INVALID_GOAL and the reason, and so is one whose place another
    trajectory takes, as joint_trajectory_controller does. It succeeds when the robot has got to the time of its last
    point; tolerances are not looked at.

    Args:
        node: in whose name.
        follow: starts a trajectory in place of the one before, and returns the stamp of its last point [ns].
        stop: lets the joints stay where they are.
    """

    def __init__(self, node: GraphNode, follow: Callable[[Trajectory], int], stop: Callable[[], None]) -> None:
        self._node, self._follow, self._stop = node, follow, stop
        self._goal: _Goal | None = None
        try:
            self._type = import_module("control_msgs.action").FollowJointTrajectory
        except ImportError:
            return
        self._server = ActionServer(
            node,
            self._type,
            NAME,
            self.execute,
            cancel_callback=self.cancel,
        )

    def replace(self) -> None:
        """Something else moves the joints now."""
        self._finish(REPLACED)

    def look(self, stamp: int) -> None:
        """The robot has got to a stamp [ns]."""
        if self._goal is not None and stamp >= self._goal.end:
            self._finish("")

    async def execute(self, handle: Any) -> Any:
        """Follow a goal to its end; returns the result."""
        result = self._type.Result()
        try:
            end = self._follow(trajectory_in(handle.request.trajectory))
        except SpaceRobotError as error:
            self._node.refuse(JOINT_TRAJECTORY, error)
            handle.abort()
            result.error_code, result.error_string = INVALID_GOAL, str(error)
            return result
        goal = _Goal(end, Future())
        self._goal = goal
        outcome = await goal.outcome
        {"": handle.succeed, CANCELLED: handle.canceled}.get(outcome, handle.abort)()
        result.error_code, result.error_string = SUCCESSFUL if outcome != REPLACED else INVALID_GOAL, outcome
        return result

    def cancel(self, _: Any) -> CancelResponse:
        """Let the joints stay where their reference is."""
        self._stop()
        self._finish(CANCELLED)
        return CancelResponse.ACCEPT

    def _finish(self, outcome: str) -> None:
        goal, self._goal = self._goal, None
        if goal is not None:
            goal.outcome.set_result(outcome)
