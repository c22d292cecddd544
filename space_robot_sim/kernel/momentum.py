"""Momentum and kinetic energy of the whole robot in one pass from the base out."""

from __future__ import annotations

import math

from space_robot_description.kernel.arrays import (
    BASE,
    INERTIA,
    MASS,
    MOMENT,
    ORIGIN,
    PARENT,
    PRISMATIC,
    ROTATION,
    RobotArrays,
)
from space_robot_description.kernel.coupling import POSITION, RATE, of_joint
from space_robot_description.kernel.inverse_dynamics import place, twist_through
from space_robot_description.kernel.jit import constants, inner, kernel
from space_robot_description.kernel.quaternion import attitude, matrix
from space_robot_description.kernel.spatial import (
    Vec,
    add,
    cross,
    dot,
    get3,
    get6,
    get9,
    mul,
    mul_sym,
    product,
    put3,
    scaled,
)
from space_robot_msgs_py.interfaces import Vector

# What `balance` writes: momentum about the inertial origin, energy, sums of the bodies' own magnitudes.
LINEAR, ANGULAR, ENERGY, GROSS_LINEAR, GROSS_ANGULAR, BALANCE_SIZE = constants(0, 3, 6, 7, 8, 9)
_W, _V, _TURN, _PLACE = constants(12, 15, 18, 27)


@kernel
def balance(robot: RobotArrays, y: Vector, axes: Vector, wheels: Vector, work: Vector, out: Vector) -> None:
    """Momentum about the inertial origin with the wheels', kinetic energy without their spin, and gross momenta.

    Args:
        robot: the robot.
        y: state; its quaternion is unit.
        axes: (3, k) wheel axes, body frame.
        wheels: (k,) momentum of each wheel relative to the body [N m s].
        work: (1+N, WORKSPACE) scratch.
        out: (9,) receives linear(3), angular(3), energy, and the sums over bodies of |m v| and |angular momentum|.
    """
    for k in range(BALANCE_SIZE):
        out[k] = 0.0
    for body in range(robot.links.shape[0]):
        _move(robot, body, y, work)
        _account(robot.links, body, work, out)
    for wheel in range(wheels.shape[0]):
        spin = scaled(wheels[wheel], mul(get9(work, BASE, _TURN), (axes[0, wheel], axes[1, wheel], axes[2, wheel])))
        _add_angular(out, spin)


@inner
def _move(robot: RobotArrays, body: int, y: Vector, work: Vector) -> None:
    """Velocity of a body in its own frame, its rotation and place in the inertial one."""
    n = robot.motors.shape[0]
    if body == 0:
        k = 7 + n
        v, w = (y[k], y[k + 1], y[k + 2]), (y[k + 3], y[k + 4], y[k + 5])
        turn, origin = matrix(attitude(y)), (y[0], y[1], y[2])
    else:
        place(robot, body, of_joint(robot.coupling, y, 7, body - 1, POSITION), work)
        above = robot.tree[body, PARENT]
        relative, shift = get9(work, body, ROTATION), get3(work, body, ORIGIN)
        turn_above = get9(work, above, _TURN)
        turn, origin = product(turn_above, relative), add(get3(work, above, _PLACE), mul(turn_above, shift))
        twist = get3(work, above, _W), get3(work, above, _V)
        rate = of_joint(robot.coupling, y, 13 + n, body - 1, RATE)
        w, v = twist_through(relative, shift, twist, rate, robot.tree[body, PRISMATIC])
    put3(work, body, _W, w)
    put3(work, body, _V, v)
    for k in range(9):
        work[body, _TURN + k] = turn[k]
    put3(work, body, _PLACE, origin)


@inner
def _account(links: Vector, body: int, work: Vector, out: Vector) -> None:
    """Add one body's share to every sum."""
    v, w, moment = get3(work, body, _V), get3(work, body, _W), get3(links, body, MOMENT)
    linear = add(scaled(links[body, MASS], v), cross(w, moment))
    angular = add(mul_sym(get6(links, body, INERTIA), w), cross(moment, v))
    out[ENERGY] += 0.5 * (dot(v, linear) + dot(w, angular))
    turn = get9(work, body, _TURN)
    linear = mul(turn, linear)
    for k in range(3):
        out[LINEAR + k] += linear[k]
    out[GROSS_LINEAR] += math.sqrt(dot(linear, linear))
    _add_angular(out, add(mul(turn, angular), cross(get3(work, body, _PLACE), linear)))


@inner
def _add_angular(out: Vector, angular: Vec) -> None:
    for k in range(3):
        out[ANGULAR + k] += angular[k]
    out[GROSS_ANGULAR] += math.sqrt(dot(angular, angular))
