"""References of the end effector: the tool from pose to pose, the joints by generalised inverse kinematics."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable
from math import radians

import numpy as np

from space_robot_control.references.points import PointToPoint
from space_robot_control.references.profile import in_body, nanoseconds, quintic
from space_robot_control.references.spec import EndEffectorPoint, EndEffectorSpec, ToolTarget
from space_robot_control.references.spline import RestToRestSpline
from space_robot_control.references.targets import check_limits, configuration
from space_robot_control.references.tool_kinematics import Aim, Pose, ToolKinematics, tool_pose
from space_robot_description.robot import Robot
from space_robot_description.rotations import exp, from_rpy, log, normalized, product, relative
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import NANOSECONDS, Reference, Vector

# With pieces this short the tool leaves lines of a third of a metre by less than a nanometre (tests hold it to that).
KNOTS = 65

Posture = Callable[[Vector, Vector, float, float], Vector]


class Leg:
    """One rest-to-rest motion: base attitude on its geodesic, base position and joints on one C4 spline.

    Args:
        base: how the base moves, and the joints where ``posture`` does not prescribe them.
        posture: the configuration at a knot from that of ``base`` (7+n,), the joints of the knot before (n,), the share
            s in [0, 1] of the way and the time [s].
        first: (7+n,) configuration to start from.
        start: [ns].
        duration: [ns].
    """

    def __init__(self, base: PointToPoint, posture: Posture, first: Vector, start: int, duration: int) -> None:
        self._base, self._start, self._duration = base, start, duration
        q, rows = np.array(first), [np.concatenate((first[:3], first[7:]))]
        times = np.linspace(0.0, duration / NANOSECONDS, KNOTS)
        for time in times[1:].tolist():
            stamp = start + round(time * NANOSECONDS)
            share = quintic(time * NANOSECONDS / duration)[0]
            q = posture(np.array(base.motion(stamp)[0]), q[7:], share, start / NANOSECONDS + time)
            rows.append(np.concatenate((q[:3], q[7:])))
        self.spline = RestToRestSpline(times.tolist(), np.array(rows))
        self.last = q

    def motion(self, stamp: int) -> tuple[list[float], list[float], list[float]]:
        """Return q (7+n,), v and a (6+n,) at a stamp [ns], the linear parts of v and a in the inertial frame."""
        q, v, a = self._base.motion(stamp)
        elapsed = min(max(stamp - self._start, 0), self._duration) / NANOSECONDS
        x, dx, ddx = self.spline.at(elapsed)
        if not 0 < stamp - self._start < self._duration:
            dx = ddx = [0.0] * len(x)
        return [*x[:3], *q[3:7], *x[3:]], [*dx[:3], *v[3:6], *dx[3:]], [*ddx[:3], *a[3:6], *ddx[3:]]


class EndEffector:
    """Legs one after the other; before the first it rests at its start, after the last at its end.

    Args:
        stamps: when each leg starts, increasing [ns].
        legs: as many.
    """

    def __init__(self, stamps: list[int], legs: list[Leg]) -> None:
        self._stamps, self._legs = stamps, legs

    def at(self, stamp: int) -> Reference:
        """Return the reference at a stamp [ns]."""
        leg = self._legs[max(bisect_right(self._stamps, stamp) - 1, 0)]
        return in_body(stamp, *leg.motion(stamp))


def end_effector(spec: EndEffectorSpec, robot: Robot, initial_q: Vector, key: str) -> EndEffector:
    """Build from a spec; each target inherits what it leaves out from the one before.

    Raises:
        SpecError: a target or the times cannot be used, is out of reach, near a singularity or beyond a joint limit.
    """
    kinematics = ToolKinematics(robot, initial_q, spec.smallest_singular_value)
    stamps, legs, q, begin = [], [], initial_q, 0
    for index, point in enumerate(spec.points):
        where = f"{key}.points.{index}"
        end = nanoseconds(point.time, f"{where}.time")
        if end <= begin:
            accepted = f"more than {begin / NANOSECONDS:g} [s]"
            raise SpecError("not later than the point before", key=f"{where}.time", value=point.time, accepted=accepted)
        if robot.base_mode == "free_floating" and point.position is not None:
            accepted = "no position: without a force it follows from attitude and joints"
            raise SpecError("the base floats freely", key=f"{where}.position", accepted=accepted)
        base = PointToPoint(q, configuration(point, robot, q, where), begin, end - begin)
        posture = posture_of(point, robot, kinematics, q, where)
        stamps.append(begin)
        legs.append(Leg(base, posture, q, begin, end - begin))
        lowest, highest = legs[-1].spline.bounds()
        check_limits(lowest[3:], highest[3:], robot, f"{where} (between the points)")
        q, begin = legs[-1].last, end
    return EndEffector(stamps, legs)


def posture_of(point: EndEffectorPoint, robot: Robot, kinematics: ToolKinematics, first: Vector, key: str) -> Posture:
    """Return how a leg from a configuration (7+n,) to a point finds the joints at each knot."""
    if point.tool is None and not point.tools:
        return lambda planned, joints, share, time: kinematics.settled(planned)
    ways = [_Way(robot.tool_frame, point.tool, robot, first, f"{key}.tool")] if point.tool is not None else []
    ways += [
        _Way(_link(robot, name, key), tool, robot, first, f"{key}.tools.{name}") for name, tool in point.tools.items()
    ]
    where = f"{key}.tool" if point.tool is not None else f"{key}.tools"

    def posture(planned: Vector, joints: Vector, share: float, time: float) -> Vector:
        guess = np.concatenate((planned[:7], joints))
        return kinematics.solve(guess, [way.at(share) for way in ways], key=where, time=time)

    return posture


class _Way:
    """A tool from where it is to its target, on a straight line and a geodesic."""

    def __init__(self, link: str, tool: ToolTarget, robot: Robot, first: Vector, key: str) -> None:
        self._link, self._orientation = link, tool.orientation == "held"
        self._start = tool_pose(robot, first, link)
        self._end = _target(tool, self._start, key)
        self._turn = np.array(log(relative(self._start.quaternion, self._end.quaternion)))

    def at(self, share: float) -> Aim:
        """After a share of the way."""
        position = self._start.position + share * (self._end.position - self._start.position)
        pose = Pose(position, product(self._start.quaternion, exp(share * self._turn)))
        return Aim(self._link, pose, self._orientation)


def _link(robot: Robot, name: str, key: str) -> str:
    if name not in robot.tools:
        accepted = ", ".join(robot.tools) or "tool: of a robot with a single one"
        raise SpecError("no such tool", key=f"{key}.tools.{name}", value=name, accepted=accepted)
    return robot.tools[name]


def _target(tool: ToolTarget, start: Pose, key: str) -> Pose:
    position, quaternion = start.position, start.quaternion
    if tool.position is not None:
        position = np.array(tool.position)
    if tool.move_by is not None:
        position = start.position + np.array(tool.move_by)
    if tool.attitude_deg is not None:
        quaternion = from_rpy([radians(angle) for angle in tool.attitude_deg])
    if tool.quaternion is not None:
        quaternion = normalized(tool.quaternion, f"{key}.quaternion")
    return Pose(position, quaternion)
