"""References through a list of configurations at given times."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from space_robot_control.references.points import PointToPoint
from space_robot_control.references.profile import in_body, nanoseconds
from space_robot_control.references.spec import WaypointsSpec
from space_robot_control.references.spline import RestToRestSpline
from space_robot_control.references.targets import check_limits, configuration
from space_robot_description.robot import Robot
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import NANOSECONDS, Reference, Vector


class Waypoints:
    """Quintic from configuration to configuration, at rest at each; or position and joints on one smooth spline.

    Before the first time it rests in the first configuration, after the last in the last. The attitude goes along the
    geodesic to each waypoint and rests there in both modes: rotations have no spline with simple exact derivatives.

    Args:
        stamps: (m,) increasing [ns].
        configurations: (m) of (7+n,) [m, -, rad].
        spline: do not stop at the inner waypoints.

    Raises:
        SpecError: fewer than two waypoints, or times that do not increase.
    """

    def __init__(self, stamps: Sequence[int], configurations: Sequence[Vector], spline: bool = False) -> None:
        if len(stamps) < 2 or len(stamps) != len(configurations):
            raise SpecError("too few waypoints", key="stamps", value=len(stamps), accepted="two or more, one for each")
        if any(later <= earlier for earlier, later in pairwise(stamps)):
            raise SpecError("times do not increase", key="stamps", value=list(stamps), accepted="increasing [ns]")
        self._stamps = list(stamps)
        self._legs: list[PointToPoint] = []
        first = configurations[0]
        for last, (begin, end) in zip(configurations[1:], pairwise(stamps), strict=True):
            self._legs.append(PointToPoint(first, last, begin, end - begin))
            first = self._legs[-1].last
        self.spline: RestToRestSpline | None = None
        if spline:
            points = np.array([np.concatenate((q[:3], q[7:])) for q in configurations])
            self.spline = RestToRestSpline([(stamp - stamps[0]) / NANOSECONDS for stamp in stamps], points)

    def at(self, stamp: int) -> Reference:
        """Return the reference at a stamp [ns]."""
        leg = min(max(bisect_right(self._stamps, stamp) - 1, 0), len(self._legs) - 1)
        q, v, a = self._legs[leg].motion(stamp)
        if self.spline is not None and self._stamps[0] < stamp < self._stamps[-1]:
            x, dx, ddx = self.spline.at((stamp - self._stamps[0]) / NANOSECONDS)
            q = [*x[:3], *q[3:7], *x[3:]]
            v, a = [*dx[:3], *v[3:6], *dx[3:]], [*ddx[:3], *a[3:6], *ddx[3:]]
        return in_body(stamp, q, v, a)


def waypoints(spec: WaypointsSpec, robot: Robot, initial_q: Vector, key: str) -> Waypoints:
    """Build from a spec; each target inherits what it leaves out from the one before.

    Raises:
        SpecError: a target or the times cannot be used, or the spline leaves the joint limits between the waypoints.
    """
    stamps, configurations = [0], [initial_q]
    for index, point in enumerate(spec.points):
        where = f"{key}.points.{index}"
        stamp = nanoseconds(point.time, f"{where}.time")
        q = configuration(point, robot, configurations[-1], where)
        if index == 0 and stamp == 0:
            configurations = [q]
            continue
        if stamp <= stamps[-1]:
            accepted = f"more than {stamps[-1] / NANOSECONDS:g} [s]"
            raise SpecError(
                "not later than the waypoint before", key=f"{where}.time", value=point.time, accepted=accepted
            )
        stamps.append(stamp)
        configurations.append(q)
    if len(stamps) == 1:
        stamps.append(1)
        configurations.append(configurations[0])
    source = Waypoints(stamps, configurations, spline=spec.interpolation == "spline")
    if source.spline is not None:
        lowest, highest = source.spline.bounds()
        check_limits(lowest[3:], highest[3:], robot, f"{key} (spline between the waypoints)")
    return source
