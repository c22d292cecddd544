"""Is this a body that can exist? Mass, centre of mass and inertia, checked for physical consistency."""

from __future__ import annotations

from typing import Any

import numpy as np

from space_robot_description.robot import Robot
from space_robot_msgs_py.errors import InertiaError
from space_robot_msgs_py.interfaces import Vector

# Thin rods and plates meet the triangle inequality with equality; this much is round-off of the file's numbers.
ROUND_OFF = 1e-9
# Squared radius of gyration [m2] below which a moment is that of a point, whatever its sign.
POINT = 1e-15
# [kg, m, kg m2]; squares of numbers near the end of the float range would overflow.
MAX_MAGNITUDE = 1e12


def check_inertia(
    link: str, mass: float, com: Vector, inertia: Vector, *, point_mass: bool = False, allowance: float = -1.0
) -> None:
    """Refuse a body that cannot exist.

    Args:
        link: name for the message.
        mass: [kg].
        com: (3,) centre of mass [m].
        inertia: (3, 3) about the centre of mass [kg m2].
        point_mass: accept an inertia of exactly zero.
        allowance: by how much a principal moment may miss its bound [kg m2]; below 0: it has to be positive.

    Raises:
        InertiaError: not finite, mass not positive, not symmetric, not positive definite, or principal moments against
            the triangle inequality Ja + Jb >= Jc.

    Reference:
        Traversaro et al. (2016), "Identification of fully physical consistent inertial parameters", Sec. II.
    """
    key = f"link {link}"
    for name, value in (("mass", mass), ("com", com), ("inertia", inertia)):
        found = np.asarray(value).tolist()
        if not np.isfinite(value).all():
            raise InertiaError(f"{name} is not finite", key=key, value=found, accepted="finite numbers")
        if np.max(np.abs(value)) > MAX_MAGNITUDE:
            raise InertiaError(
                f"{name} is beyond any spacecraft", key=key, value=found, accepted=f"below {MAX_MAGNITUDE:g}"
            )
    if mass <= 0.0:
        raise InertiaError("mass is not positive", key=key, value=float(mass), accepted="> 0 kg")
    if point_mass and not np.any(inertia):
        return
    if np.max(np.abs(inertia - inertia.T)) > ROUND_OFF * np.max(np.abs(inertia)):
        raise InertiaError("inertia is not symmetric", key=key, value=inertia.tolist(), accepted="I = I^T")
    _check_moments(key, inertia, allowance)


def check_body(link: str, mass: float, com: Vector, inertia: Vector) -> None:
    """Refuse a moving body that cannot exist; point masses, rods and plates are limits of bodies that do.

    A body without mass is a frame between two joints, if it has no inertia either: whether the robot can move with it
    is a question for the mass matrix.

    Args:
        link: name for the message.
        mass: [kg], with all links that are fixed to it.
        com: (3,) centre of mass [m].
        inertia: (3, 3) about the centre of mass [kg m2].

    Raises:
        InertiaError: see `check_inertia`; moments may be zero, and negative by round-off.
    """
    if mass == 0.0 and not np.any(inertia):
        return
    check_inertia(link, mass, com, inertia, point_mass=True, allowance=ROUND_OFF * _largest(inertia) + POINT * mass)


def pseudo_inertia(parameters: Vector) -> Vector:
    """The (4, 4) pseudo-inertia of a body; the body is physically consistent exactly if it is positive definite.

    Args:
        parameters: (10,) [m, m c, Ixx, Ixy, Iyy, Ixz, Iyz, Izz] about the frame origin, Pinocchio's order.

    Reference:
        Wensing, Kim, Slotine (2018), "Linear matrix inequalities for physically consistent inertial parameters", (10).
    """
    mass, first = parameters[0], parameters[1:4]
    ixx, ixy, iyy, ixz, iyz, izz = parameters[4:]
    inertia = np.array([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]])
    out = np.empty((4, 4))
    out[:3, :3] = 0.5 * np.trace(inertia) * np.eye(3) - inertia
    out[:3, 3] = out[3, :3] = first
    out[3, 3] = mass
    return out


def is_consistent(parameters: Vector, *, limit: bool = False) -> bool:
    """True if a body with these ten parameters (Pinocchio's order) can exist.

    Args:
        parameters: (10,).
        limit: accept points, rods and plates too, which are limits of bodies.
    """
    if not np.isfinite(parameters).all():
        return False
    pseudo = pseudo_inertia(parameters)
    least = float(np.linalg.eigvalsh(pseudo)[0])
    return least > 0.0 or (limit and least >= -ROUND_OFF * float(np.trace(pseudo)))


def inertial_parameters(robot: Robot) -> Vector:
    """The (1+N, 10) inertial parameters of all bodies, base first, each in its joint frame.

    Returns:
        Rows [m, m cx, m cy, m cz, Ixx, Ixy, Iyy, Ixz, Iyz, Izz], inertia about the joint origin [kg, kg m, kg m2].
    """
    inertias: Any = robot.model.inertias
    return np.array([inertias[index].toDynamicParameters() for index in range(1, len(inertias))])


def _largest(inertia: Vector) -> float:
    return float(np.max(np.abs(inertia)))


def _check_moments(key: str, inertia: Vector, allowance: float) -> None:
    moments = np.linalg.eigvalsh(inertia)
    if moments[0] <= 0.0 and moments[0] < -allowance:
        raise InertiaError(
            "inertia is not positive definite", key=key, value=moments.tolist(), accepted="principal moments > 0 kg m2"
        )
    if moments[0] + moments[1] < moments[2] - max(allowance, ROUND_OFF * moments[2]):
        raise InertiaError(
            "inertia violates the triangle inequality",
            key=key,
            value=moments.tolist(),
            accepted="principal moments with Ja + Jb >= Jc",
        )
