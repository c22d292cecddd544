"""Guidance node of a run whose set-points come from outside."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from typing import Any

from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.subscription import Subscription

from space_robot_control.nodes.follow_trajectory import TrajectoryAction
from space_robot_control.nodes.guidance import GuidanceNode
from space_robot_control.nodes.set_point_messages import pose_in, trajectory_in, twist_in
from space_robot_control.references.live import LiveReference
from space_robot_control.references.trajectory import Trajectory
from space_robot_msgs_py.errors import SpaceRobotError
from space_robot_msgs_py.interfaces import NANOSECONDS
from space_robot_msgs_py.nodes.diagnostics import Diagnostics
from space_robot_msgs_py.nodes.mismatches import mismatches
from space_robot_msgs_py.nodes.reasons import RecentCounts
from space_robot_msgs_py.ros import to_msg
from space_robot_msgs_py.set_points import BASE_GOAL, JOINT_TRAJECTORY, TELEOP, TOOL_GOAL
from space_robot_msgs_py.topics import Topic

# A reference is given out when its state is heard, so that none of a run before is under way after a reset.
AHEAD = 0
DIAGNOSTICS_PERIOD = 1.0


class LiveGuidanceNode(GuidanceNode):
    """Publishes references as set-points move them; what it made of them is in the log.

    It listens to ``joint_trajectory``, ``base/goal``, ``tool/goal`` and ``teleop``, and where control_msgs is installed
    to the action ``~/follow_joint_trajectory``. What cannot be done is refused and counted, with its reason on
    ``/diagnostics``, and changes nothing.

    Args:
        reference: what the set-points move.
        joint_names: the robot's joints in model order.
        period: control period [ns].
        steps: number of periods of the run.
        options: see GuidanceNode.

    Attributes:
        reference: as given.
        accepted: how many set-points were accepted, by topic.
    """

    def __init__(
        self, reference: LiveReference, joint_names: tuple[str, ...], *, period: int, steps: int, **options: Any
    ) -> None:
        self.reference, self.accepted = reference, Counter[str]()
        super().__init__(reference, joint_names, period=period, steps=steps, ahead=AHEAD, **options)
        self._diagnostics, self._recent = Diagnostics(self, "flight software"), RecentCounts()
        self._action = TrajectoryAction(self, self._follow, reference.stop_joints)
        self._heard: list[Subscription] = [
            self._obey(JOINT_TRAJECTORY, lambda message: self._follow(trajectory_in(message))),
            self._obey(BASE_GOAL, lambda message: reference.go_to(*pose_in(message, BASE_GOAL.name))),
            self._obey(TOOL_GOAL, lambda message: reference.bring_tool(*pose_in(message, TOOL_GOAL.name))),
            self._obey(TELEOP, lambda message: reference.move_tool(twist_in(message))),
        ]
        clock = Clock(clock_type=ClockType.STEADY_TIME)
        self._health_timer = self.create_timer(DIAGNOSTICS_PERIOD, self._on_timer, clock=clock)

    def begin_again(self) -> None:
        """The plant was reset: set-points of the run before are forgotten."""
        self.reference.reset()
        self._action.replace()
        super().begin_again()

    def reached(self, tick: int) -> None:
        """The robot has got to a tick."""
        self._action.look(tick * self._period)

    def _obey(self, topic: Topic, act: Callable[[Any], object]) -> Subscription:
        def on_message(raw: bytes) -> None:
            try:
                message = to_msg(topic, raw)
            except Exception as error:
                # Whatever the middleware says of bytes that are no message.
                self.refuse(topic, f"not a {topic.type}: {error}")
                return
            try:
                act(message)
            except SpaceRobotError as error:
                self.refuse(topic, error)
                return
            self.accepted[topic.name] += 1

        return self.listen(topic, on_message)

    def _follow(self, trajectory: Trajectory) -> int:
        end = self.reference.follow(trajectory)
        self._action.replace()
        self.get_logger().info(f"follows a trajectory of {len(trajectory.points)} points until {end / NANOSECONDS:g} s")
        return end

    def _on_timer(self) -> None:
        said: dict[str, float | str] = {"doing": self.reference.doing}
        said |= {f"accepted_{name}": float(count) for name, count in sorted(self.accepted.items())}
        said |= {f"refused_{name}": float(count) for name, count in sorted(self.refusals.items())}
        said |= self.reasons.values()
        warnings = [f"refused {name}" for name in self._recent.grown(self.refusals)]
        warnings += dict.fromkeys(mismatches(self, self._heard))
        self._diagnostics.publish(self.reference.now, [self._diagnostics.status("set-points", warnings, "ready", said)])
