"""A reference that set-points from outside move while the run goes on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import hypot, radians

import numpy as np

from space_robot_control.references.base_path import PEAK, BaseMotion, BasePath, path_to
from space_robot_control.references.end_effector import Leg, posture_of
from space_robot_control.references.joint_path import JointPath, JointPoint
from space_robot_control.references.points import PointToPoint
from space_robot_control.references.profile import in_body
from space_robot_control.references.spec import EndEffectorPoint, LiveSpec, ToolTarget
from space_robot_control.references.targets import check_limits, initial_configuration
from space_robot_control.references.teleop import Motion, Teleop
from space_robot_control.references.tool_kinematics import Pose, ToolKinematics, tool_pose
from space_robot_control.references.trajectory import Trajectory, points_of
from space_robot_description.robot import Robot
from space_robot_description.rotations import Quaternion, log, normalized, relative
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import NANOSECONDS, Reference, Vector
from space_robot_msgs_py.set_points import SET_POINTS
from space_robot_msgs_py.vectors import vector

JOINTS, BASE, TOOL, TELEOP = (topic.name for topic in SET_POINTS)
MAX_DISTANCE = 1e6  # [m]


@dataclass(frozen=True, eq=False, slots=True)
class _ToolMotion:
    """A motion of the whole robot for the sake of its tool, and when it is at rest [ns]."""

    leg: Leg
    end: int


class LiveReference:
    """Holds the initial configuration until set-points come; each acts from the stamp after the newest reference.

    A trajectory of the joints takes over from whatever moves them, a goal of the base from another one. The tool takes
    the whole robot: it starts from rest, and until it rests again base goals are refused. What was given out stays as
    it is: the same set-points between the same stamps give the same references.

    Args:
        spec: limits of speed.
        robot: the NOMINAL robot.
        initial_q: (7+n,) configuration at the start of the run [m, -, rad].
        period: control period [ns].
        steps: number of periods of the run.

    Attributes:
        now: stamp of the newest reference that was given out [ns].

    Raises:
        SpecError: the initial configuration cannot be one.
    """

    _base: BasePath
    _joints: JointPath

    def __init__(self, spec: LiveSpec, robot: Robot, initial_q: Vector, *, period: int, steps: int) -> None:
        self._spec, self._robot, self._period = spec, robot, period
        self._end, self._initial = period * steps, initial_configuration(initial_q, robot)
        self._tool: _ToolMotion | None = None
        self._teleop: Teleop | None = None
        self.reset()

    def reset(self) -> None:
        """Back to the initial configuration, at stamp 0."""
        self.now, still = 0, [0.0] * (self._initial.size - 1)
        self._state: Motion = self._initial.tolist(), still, still
        self._rest()

    def at(self, stamp: int) -> Reference:
        """Return the reference at a stamp, one period after the one before it [ns]."""
        self.now, self._state = stamp, self._motion(stamp)
        done = self._tool is not None and stamp >= self._tool.end
        if done or (self._teleop is not None and self._teleop.resting):
            self._rest()
        return in_body(stamp, *self._state)

    @property
    def tool(self) -> Pose:
        """Pose of the tool in the newest reference."""
        return tool_pose(self._robot, np.array(self._state[0]))

    @property
    def doing(self) -> str:
        """The set-points that move the reference now, and why they do not; `at rest` where there are none."""
        if self._teleop is not None:
            return self._teleop.stopped_by or TELEOP
        moving = [TOOL] if self._tool is not None else []
        moving += [name for name, path in ((JOINTS, self._joints), (BASE, self._base)) if path.end > self.now]
        return ", ".join(moving) or "at rest"

    def follow(self, trajectory: Trajectory) -> int:
        """Move the joints through points in time; returns the stamp of the last one [ns].

        Raises:
            SpecError: the trajectory cannot be followed; nothing has changed.
        """
        x, dx, ddx = (np.array(part[-self._robot.n :]) for part in self._state)
        first = JointPoint(self.now, x, dx, ddx)
        path = JointPath(points_of(trajectory, first, self._robot.joint_names, self._end))
        self._check(path, x)
        if self._tool is not None or self._teleop is not None:
            self._rest()
        self._joints = path
        return path.end

    def stop_joints(self) -> None:
        """Let the joints stay where the newest reference is, if a trajectory moves them."""
        if self._tool is None and self._teleop is None:
            self._joints = JointPath([JointPoint(self.now, np.array(self._state[0][7:]))])

    def go_to(self, position: Sequence[float], quaternion: Sequence[float]) -> None:
        """Bring the base to rest in a pose; a free-floating one turns and its position is not looked at.

        Args:
            position: (3,) inertial [m].
            quaternion: x, y, z, w, of any length but zero.

        Raises:
            SpecError: not a pose, or the tool moves.
        """
        where, attitude = _pose(position, quaternion, BASE)
        if self._tool is not None or self._teleop is not None:
            raise SpecError("the tool moves the robot", key=BASE, value=self.doing, accepted="a goal when it rests")
        first = self._base.at(self.now)
        target = first.position if self._robot.base_mode == "free_floating" else where.tolist()
        limits = self._spec.base_speed, radians(self._spec.base_rate_deg)
        self._base = path_to(first, target, attitude, self.now, *limits)

    def bring_tool(self, position: Sequence[float], quaternion: Sequence[float]) -> None:
        """Bring the tool to rest in a pose, on a straight line and a geodesic, while the base keeps its attitude.

        With fewer than six joints only the position counts.

        Args:
            position: (3,) inertial [m].
            quaternion: x, y, z, w, of any length but zero.

        Raises:
            SpecError: not a pose, out of reach, near a singularity, beyond a limit, or the reference moves.
        """
        where, attitude = _pose(position, quaternion, TOOL)
        self._check_rest(TOOL)
        q = np.array(self._state[0])
        start = self.tool
        turn = hypot(*log(relative(start.quaternion, attitude))) if self._robot.n >= 6 else 0.0
        far = float(np.linalg.norm(where - start.position))
        seconds = PEAK * max(far / self._spec.tool_speed, turn / radians(self._spec.tool_rate_deg))
        duration = max(round(seconds * NANOSECONDS), self._period)
        how = {"quaternion": attitude} if self._robot.n >= 6 else {"orientation": "free"}
        tool = ToolTarget.model_validate({"position": where.tolist(), **how})
        point = EndEffectorPoint(time=duration / NANOSECONDS, tool=tool)
        kinematics = ToolKinematics(self._robot, q, self._spec.smallest_singular_value)
        base = PointToPoint(q, q, self.now, duration)
        leg = Leg(base, posture_of(point, self._robot, kinematics, q, TOOL), q, self.now, duration)
        lowest, highest = leg.spline.bounds()
        check_limits(lowest[3:], highest[3:], self._robot, TOOL)
        self._tool = _ToolMotion(leg, self.now + duration)

    def move_tool(self, twist: Sequence[float]) -> None:
        """Move the tool with a twist (6,) in its own axes, linear then angular [m/s, rad/s].

        Raises:
            SpecError: something else moves the reference, or the arm cannot.
            NonFiniteError: a number is not finite.
        """
        wanted = vector(twist, 6, TELEOP)
        if self._teleop is None:
            self._check_rest(TELEOP)
            if self._robot.n < 3:
                raise SpecError("the arm cannot follow", key=TELEOP, value=self._robot.n, accepted="three joints")
            self._teleop = Teleop(self._spec, self._robot, np.array(self._state[0]), self.now, self._period)
        self._teleop.say(wanted, self.now)

    def _motion(self, stamp: int) -> Motion:
        if self._teleop is not None:
            return self._teleop.step(stamp)
        if self._tool is not None:
            return self._tool.leg.motion(stamp)
        base, (x, dx, ddx) = self._base.at(stamp), self._joints.at(stamp)
        return (
            [*base.position, *base.quaternion, *x],
            [*base.velocity, *base.rate, *dx],
            [*base.acceleration, *base.rate_change, *ddx],
        )

    def _rest(self) -> None:
        """Stay where the newest reference is."""
        q = self._state[0]
        self._base = BasePath(BaseMotion(q[:3], q[3:7]), q[:3], q[3:7], self.now, 0)
        self._joints = JointPath([JointPoint(self.now, np.array(q[7:]))])
        self._tool = self._teleop = None

    def _check_rest(self, key: str) -> None:
        if self.doing != "at rest":
            raise SpecError("the reference moves", key=key, value=self.doing, accepted="one that is at rest")

    def _check(self, path: JointPath, first: Vector) -> None:
        """At every stamp at which it will be given out."""
        last = min(path.end, self._end)
        stamps = [*range(self.now + self._period, last, self._period), last]
        rows = path.positions(stamps)
        check_limits(rows.min(axis=0), rows.max(axis=0), self._robot, JOINTS)
        steps = np.diff(np.vstack((first, rows)), axis=0)
        rates = np.abs(steps).max(axis=0) / (self._period / NANOSECONDS)
        for name, rate, limit in zip(self._robot.joint_names, rates, self._robot.joint_rate_limit, strict=True):
            if rate > limit:
                accepted = f"at most {float(limit):g} [rad/s or m/s]"
                raise SpecError("too fast", key=f"{JOINTS}.{name}", value=float(rate), accepted=accepted)


def _pose(position: Sequence[float], quaternion: Sequence[float], key: str) -> tuple[Vector, Quaternion]:
    where = vector(position, 3, f"{key}.position")
    if float(np.abs(where).max()) > MAX_DISTANCE:
        raise SpecError("too far", key=f"{key}.position", value=where.tolist(), accepted=f"up to {MAX_DISTANCE:g} m")
    return where, normalized(vector(quaternion, 4, f"{key}.orientation"), f"{key}.orientation")
