"""What laws that bring a robot to rest have in common: the nominal robot, errors as telemetry, room to work in."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from space_robot_control.kernel.actuators import Actuators, common_scale
from space_robot_control.kernel.mass import MassWork, inertia_times, mass_work
from space_robot_control.kernel.tracking import track
from space_robot_description.kernel.arrays import RobotArrays
from space_robot_description.kernel.jit import inner
from space_robot_msgs_py.interfaces import Vector


class RestRobot(NamedTuple):
    """The nominal robot.

    Attributes:
        robot: its bodies.
        able: its actuators.
        mass: of all bodies [kg].
        floating: 1: no force acts on the base.
    """

    robot: RobotArrays
    able: Actuators
    mass: float
    floating: int


class RestRoom(NamedTuple):
    """Tracking errors, and room for the rest.

    Attributes:
        rate: (1,) w [1/s].
        acceleration: (6+n,) that is wanted.
        configuration: (6+n,) tracking errors.
        velocity: (6+n,) tracking errors.
        feedforward: (6+n,) tracking errors.
        quaternion: (4,) tracking errors.
        work: of the inertia.
    """

    rate: npt.NDArray[np.float64]
    acceleration: npt.NDArray[np.float64]
    configuration: npt.NDArray[np.float64]
    velocity: npt.NDArray[np.float64]
    feedforward: npt.NDArray[np.float64]
    quaternion: npt.NDArray[np.float64]
    work: MassWork


def rest_room(joints: int, followers: int = 0) -> RestRoom:
    """Room for that many joints, and others that follow them."""
    size = 6 + joints
    errors = np.zeros(size), np.zeros(size), np.zeros(size), np.zeros(4)
    return RestRoom(np.zeros(1), np.zeros(size), *errors, mass_work(joints, followers))


def rest_example() -> tuple[RestRobot, RestRoom]:
    """Of the types that all laws are compiled for."""
    one, none = np.zeros(1), np.zeros((1, 1))
    robot = RobotArrays(np.zeros((1, 3), dtype=np.int64), none, none)
    return RestRobot(robot, Actuators(one, none, none, 1.0), 1.0, 0), rest_room(0)


@inner
def show_errors(room: RestRoom, q: Vector, v: Vector, q_d: Vector, v_d: Vector, a_d: Vector, row: Vector) -> int:
    """Write the tracking errors at the beginning of a row of telemetry; returns how many there are."""
    track(q, v, q_d, v_d, a_d, room.configuration, room.velocity, room.feedforward, room.quaternion)
    size: int = v.shape[0]
    for i in range(size):
        row[i], row[size + i] = room.configuration[i], room.velocity[i]
    return 2 * size


@inner
def push_within_limits(known: RestRobot, room: RestRoom, q: Vector, u: Vector) -> float:
    """Write u = s H a for the wanted acceleration; returns s in [0, 1], or -1: not finite."""
    if not inertia_times(known.robot, known.mass, known.floating, q, room.acceleration, room.work, u):
        return -1.0
    scale: float = common_scale(known.able, u)
    for i in range(u.shape[0]):
        u[i] = scale * u[i]
    return scale
