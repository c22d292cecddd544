"""The mass matrix of a model, symmetric, and whether it can be inverted; laws and plant have ways of their own."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pinocchio as pin

from space_robot_msgs_py.errors import InertiaError
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.products import times

# Smallest eigenvalue of the mass matrix scaled to a diagonal of 1. Round-off is 1e-16 per coordinate; the stiffest real
# robots have 1e-7.
SINGULAR = 1e-12


def mass_matrix(model: Any, q: Vector) -> Vector:
    """Return M(q) (6+n, 6+n) [kg, kg m, kg m2].

    Of joints that mimic others, too: ``pin.crba`` then adds to what its data hold from a call before, so data are new.

    Args:
        model: ``pin.Model`` of a robot.
        q: (7+n,) configuration [m, -, rad or m].
    """
    upper = np.triu(pin.crba(model, model.createData(), q))
    full: Vector = upper + np.triu(upper, 1).T
    return full


def reduced_mass_matrix(model: Any, joints: Vector) -> Vector:
    """Return (3+n, 3+n) of base rotation and joints, the translation of the base eliminated [kg m2, kg m, kg].

    ``M_red = M_rr - M_rt M_tt^-1 M_tr`` with t: base translation, r: base rotation and joints; M_tt is mass times
    identity.

    Args:
        model: ``pin.Model`` of a robot.
        joints: (n,) positions; the pose of the base does not matter [rad or m].
    """
    full = mass_matrix(model, np.concatenate([pin.neutral(model)[:7], joints]))
    reduced: Vector = full[3:, 3:] - times(full[3:, :3], full[:3, 3:]) / full[0, 0]
    return reduced


def coupling_condition(model: Any, joints: Vector) -> float:
    """2-norm condition number of the reduced mass matrix; radians and metres are mixed where joints are prismatic."""
    return float(np.linalg.cond(reduced_mass_matrix(model, joints)))


def check_invertible(model: Any, q: Vector, bodies: Sequence[str]) -> None:
    """Refuse a robot that no finite effort moves: its mass matrix is singular.

    Bodies that are points, rods or massless are fine as long as something heavy turns with every joint.

    Args:
        model: ``pin.Model`` of a robot.
        q: (7+n,) configuration [m, -, rad or m].
        bodies: (1+n) names, base first.

    Raises:
        InertiaError: it names the body on which the least inertia acts.
    """
    full = mass_matrix(model, q)
    size = np.sqrt(np.maximum(np.diag(full), 0.0))
    if np.all(size > 0.0):
        values, vectors = np.linalg.eigh(full / np.outer(size, size))
        if values[0] > SINGULAR:
            return
        motion = np.abs(vectors[:, 0])
    else:
        motion = size == 0.0
    weakest = max(int(np.argmax(motion)) - 5, 0)
    raise InertiaError(
        "the mass matrix is singular at home: nothing resists a motion of this link",
        key=f"link {bodies[weakest]}",
        accepted="mass or inertia that every joint has to move",
    )
