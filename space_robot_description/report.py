"""A robot in numbers: mass, inertia, momentum capacity, reach and how strongly arm and base move each other."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin

from space_robot_description.actuation import torque_capacity
from space_robot_description.foresight import robot_warnings
from space_robot_description.inertia import inertial_parameters
from space_robot_description.mass_matrix import reduced_mass_matrix
from space_robot_description.reach import Reach, reach_of
from space_robot_description.robot import Robot
from space_robot_msgs_py.interfaces import Vector


@dataclass(frozen=True, eq=False, slots=True)
class BodyRow:
    """One body, in its joint frame: mass [kg], com (3,) [m], inertia (3, 3) about the com [kg m2]."""

    name: str
    mass: float
    com: Vector
    inertia: Vector


@dataclass(frozen=True, slots=True)
class JointReport:
    """One joint; [rad, m] and [N m, N] by ``kind``."""

    name: str
    kind: str
    body: str
    lower: float
    upper: float
    rate_limit: float
    effort: float
    lag: float
    viscous: float
    coulomb: float
    home: float


@dataclass(frozen=True, eq=False, slots=True)
class Coupling:
    """How arm and base move each other at home, after the translation is eliminated.

    With M = [[M_tt, M_tr], [M_rt, M_rr]] (t: base translation, r: base rotation and joints) the reduced mass matrix is
    ``M_red = M_rr - M_rt M_tt^-1 M_tr`` = [[H_b, H_bm], [H_bm^T, H_m]].

    Attributes:
        condition: 2-norm condition number of M_red; radians and metres are mixed if there are prismatic joints.
        rate_ratio: ``||H_b^-1 H_bm||_2``: base angular rate per joint rate of a free-floating robot without momentum.
        torque_ratio: ``||H_bm H_m^-1||_2``: torque on a held base per joint effort.

    Reference:
        Umetani, Yoshida (1989), "Resolved motion rate control of space manipulators with generalized Jacobian matrix".
    """

    condition: float
    rate_ratio: float
    torque_ratio: float


@dataclass(frozen=True, eq=False, slots=True)
class RobotReport:
    """Everything `space-robot robot` shows.

    Attributes:
        total_mass: [kg].
        bodies: base first.
        system_com: (3,) of the whole robot at home, in base_link [m].
        system_inertia: (3, 3) of the whole robot at home about its centre of mass, base_link axes [kg m2].
        momentum_capacity: (3,) largest momentum about each body axis alone that the wheels hold under the allocation by
            the pseudo-inverse of their axes [N m s]; None without wheels.
        torque_capacity: (3,) largest torque about each body axis alone [N m], wheels as above.
        force_capacity: (3,) [N]; None for a free-floating base.
        reach: of the tool, from the first joint on its chain.
        tools: of several arms: name -> link of the tool, and its reach.
        coupling: of arm and base at home.
        joints: in model order.
        actuators: as in the robot file.
        followers: joint that mimics another -> {joint, multiplier, offset}.
        notes: what the robot file changed in the URDF's inertias.
        warnings: what will probably go wrong with it.
    """

    name: str
    base_mode: str
    n: int
    total_mass: float
    bodies: tuple[BodyRow, ...]
    system_com: Vector
    system_inertia: Vector
    momentum_capacity: Vector | None
    torque_capacity: Vector
    force_capacity: Vector | None
    tool_frame: str
    reach: Reach
    coupling: Coupling
    joints: tuple[JointReport, ...]
    actuators: dict[str, Any]
    tools: dict[str, dict[str, Any]]
    followers: dict[str, dict[str, Any]]
    notes: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Plain numbers, strings and lists, fit for JSON; an infinite limit is None."""
        plain: dict[str, Any] = _plain(dataclasses.asdict(self))
        return plain


def robot_report(robot: Robot) -> RobotReport:
    """Compute the report of a robot; the same robot gives the same bits."""
    model, data = robot.model, robot.model.createData()
    home = np.concatenate([pin.neutral(model)[:7], robot.home])
    pin.ccrba(model, data, home, np.zeros(model.nv))
    torque, momentum = torque_capacity(robot)
    force = robot.actuators.base_force
    return RobotReport(
        name=robot.name,
        base_mode=robot.base_mode,
        n=robot.n,
        total_mass=float(inertial_parameters(robot)[:, 0].sum()),
        bodies=_bodies(robot),
        system_com=data.com[0].copy(),
        system_inertia=data.Ig.inertia.copy(),
        momentum_capacity=momentum,
        torque_capacity=torque,
        force_capacity=None if force is None else np.array(force.limit),
        tool_frame=robot.tool_frame,
        reach=reach_of(robot),
        coupling=coupling_at(robot, robot.home),
        joints=_joints(robot),
        actuators=robot.actuators.model_dump(mode="json"),
        tools={name: {"link": link, "reach": reach_of(robot, link)} for name, link in robot.tools.items()},
        followers={name: mimic._asdict() for name, mimic in robot.mimics.items()},
        notes=robot.notes,
        warnings=robot_warnings(robot),
    )


def coupling_at(robot: Robot, joints: Vector) -> Coupling:
    """Coupling of arm and base at the (n,) joint positions; the base pose does not matter."""
    reduced = reduced_mass_matrix(robot.model, joints)
    base, cross, arm = reduced[:3, :3], reduced[:3, 3:], reduced[3:, 3:]
    return Coupling(
        condition=float(np.linalg.cond(reduced)),
        rate_ratio=float(np.linalg.norm(np.linalg.solve(base, cross), 2)),
        torque_ratio=float(np.linalg.norm(np.linalg.solve(arm, cross.T), 2)),
    )


def _bodies(robot: Robot) -> tuple[BodyRow, ...]:
    inertias = list(robot.model.inertias)[1:]
    return tuple(
        BodyRow(name, float(body.mass), body.lever.copy(), body.inertia.copy())
        for name, body in zip(robot.body_names, inertias, strict=True)
    )


def _joints(robot: Robot) -> tuple[JointReport, ...]:
    motors = robot.actuators.joints
    return tuple(
        JointReport(
            name=name,
            kind="prismatic" if robot.prismatic[index] else "revolute",
            body=robot.body_names[robot.model.getJointId(name) - 1],
            lower=float(robot.joint_lower[index]),
            upper=float(robot.joint_upper[index]),
            rate_limit=float(robot.joint_rate_limit[index]),
            effort=float(robot.effort_limit[index]),
            lag=_of(motors.lag, index),
            viscous=_of(motors.viscous, index),
            coulomb=_of(motors.coulomb, index),
            home=float(robot.home[index]),
        )
        for index, name in enumerate(robot.joint_names)
    )


def _of(values: Any, index: int) -> float:
    return float(values[index]) if isinstance(values, tuple) else float(values)


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _plain(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(inner) for inner in value]
    if isinstance(value, np.ndarray):
        return _plain(value.tolist())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
