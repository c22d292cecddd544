"""A joint trajectory as other programs send it, checked against the robot."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from itertools import pairwise

import numpy as np

from space_robot_control.references.joint_path import JointPoint
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import NANOSECONDS, Vector
from space_robot_msgs_py.vectors import vector

KEY = "joint_trajectory"
MAX_POINTS = 10_000
# Beyond, nothing is a position or a rate [rad, m, and per second].
MAX_NUMBER = 1e6
# A final velocity up to here is taken for none, as joint_trajectory_controller does.
NO_VELOCITY = 1e-6


@dataclass(frozen=True, eq=False, slots=True)
class TrajectoryPoint:
    """One point; arrays have one number for each name of the trajectory, or none.

    Attributes:
        time: since the start of the trajectory [ns].
        positions: [rad or m].
        velocities: [rad/s or m/s]; empty: not said.
        accelerations: [rad/s2 or m/s2]; empty: not said.
    """

    time: int
    positions: Sequence[float]
    velocities: Sequence[float] = ()
    accelerations: Sequence[float] = ()


@dataclass(frozen=True, eq=False, slots=True)
class Trajectory:
    """What trajectory_msgs/JointTrajectory says.

    Attributes:
        names: of the joints, in the order of the arrays.
        points: in time.
        stamp: when it starts, since the start of the run [ns]; 0: at once.
    """

    names: Sequence[str]
    points: Sequence[TrajectoryPoint]
    stamp: int = 0


def points_of(trajectory: Trajectory, first: JointPoint, joint_names: Sequence[str], end: int) -> list[JointPoint]:
    """Return the points of all joints in model order; those that are not named stay where they are.

    Args:
        trajectory: as it came.
        first: where the joints are when it takes over; where its own first point is in the past it is not one of them.
        joint_names: of the robot.
        end: of the run [ns].

    Raises:
        SpecError: names, sizes or times do not fit, or it ends with a velocity.
        CommandError: an array has not one number for each name.
        NonFiniteError: a number is not finite.
    """
    places = _places(trajectory.names, joint_names)
    begin = trajectory.stamp or first.time
    points = [_point(trajectory, i, places, first, begin) for i in range(_number(trajectory))]
    _check_times([begin - 1, *(point.time for point in points)], begin)
    if trajectory.stamp and not (first.time < points[-1].time and begin <= end):
        said, run = trajectory.stamp / NANOSECONDS, end / NANOSECONDS
        accepted = f"0 for at once, or seconds of the run so that it ends after {first.time / NANOSECONDS:g}"
        raise SpecError(f"not in this run of {run:g} s", key=f"{KEY}.header.stamp", value=said, accepted=accepted)
    last = points[-1].velocity
    if last is not None and float(np.abs(last).max()) > NO_VELOCITY:
        where = f"{KEY}.points.{len(points) - 1}.velocities"
        raise SpecError("does not end at rest", key=where, value=last.tolist(), accepted="zeros, or none")
    return [first, *points] if points[0].time > first.time else points


def _number(trajectory: Trajectory) -> int:
    if not 0 < len(trajectory.points) <= MAX_POINTS:
        accepted = f"1 to {MAX_POINTS} points"
        raise SpecError("cannot be followed", key=f"{KEY}.points", value=len(trajectory.points), accepted=accepted)
    return len(trajectory.points)


def _places(names: Sequence[str], joint_names: Sequence[str]) -> list[int]:
    for name in names:
        if name not in joint_names:
            near = get_close_matches(name, joint_names, n=1)
            accepted = near[0] if near else ", ".join(joint_names)
            raise SpecError("no such joint", key=f"{KEY}.joint_names", value=name, accepted=accepted)
    if not names or len(set(names)) < len(names):
        raise SpecError("not names of joints, each once", key=f"{KEY}.joint_names", value=list(names))
    return [list(joint_names).index(name) for name in names]


def _point(trajectory: Trajectory, index: int, places: list[int], first: JointPoint, begin: int) -> JointPoint:
    point, key = trajectory.points[index], f"{KEY}.points.{index}"

    def whole(name: str, values: Sequence[float], rest: Vector) -> Vector:
        out, given = np.array(rest), vector(values, len(places), f"{key}.{name}")
        if float(np.abs(given).max()) > MAX_NUMBER:
            raise SpecError("too large", key=f"{key}.{name}", value=given.tolist(), accepted=f"up to {MAX_NUMBER:g}")
        out[places] = given
        return out

    still = np.zeros_like(first.position)
    velocity = whole("velocities", point.velocities, still) if len(point.velocities) else None
    acceleration = whole("accelerations", point.accelerations, still) if len(point.accelerations) else None
    position = whole("positions", point.positions, first.position)
    return JointPoint(begin + point.time, position, velocity, acceleration)


def _check_times(times: Sequence[int], begin: int) -> None:
    for index, (before, time) in enumerate(pairwise(times)):
        if time <= before:
            seconds, least = (time - begin) / NANOSECONDS, max(before - begin, 0) / NANOSECONDS
            where = f"{KEY}.points.{index}.time_from_start"
            accepted = f"more than {least:g} [s]" if index else "0 or more [s]"
            raise SpecError("times do not increase", key=where, value=seconds, accepted=accepted)
