"""Does the model weigh what the file says? Every body against the sum over its links, in numbers of its own."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from space_robot_description.link_body import LinkBody
from space_robot_description.urdf import MOVING, Tree, child_of, kind_of, parent_of
from space_robot_description.urdf_values import numbers
from space_robot_msgs_py.errors import InertiaError
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.elementary import sincos
from space_robot_msgs_py.kernel.products import times

_AGREE = 1e-9


def check_sums(tree: Tree, bodies: Mapping[str, LinkBody], model: Any) -> None:
    """Refuse a model of which a body differs from the sum over its links.

    Compared are mass, first moment and second moments of mass in the frame of the moving body, by other equations
    than the model is made with: 4x4 pseudo-inertias under homogeneous transforms, P' = T P T^T.

    Args:
        tree: of the composed URDF.
        bodies: link name to what it weighs.
        model: ``pin.Model`` made of them.

    Raises:
        InertiaError: they differ, which is an error of this program.

    Reference:
        Wensing, Kim, Slotine (2018), "Linear matrix inequalities for physically consistent inertial parameters", (10).
    """
    sums = _sums(tree, bodies)
    for index, (link, (expected, scale)) in enumerate(sums.items(), start=1):
        found = _second_moments(model.inertias[index].mass, model.inertias[index].lever, model.inertias[index].inertia)
        if not np.all(np.abs(found - expected) <= _AGREE * _levels(scale)):
            raise InertiaError(
                "the model differs from the sum over the links", key=f"link {link}", value=found.tolist()
            )
    total, file_total = sum(body.mass for body in model.inertias), sum(body.mass for body in bodies.values())
    if not abs(total - file_total) <= _AGREE * file_total:
        raise InertiaError(
            "the model does not weigh what the URDF says", key="urdf", value=total, accepted=f"{file_total} kg"
        )


def _sums(tree: Tree, bodies: Mapping[str, LinkBody]) -> dict[str, tuple[Vector, Vector]]:
    """Moving body, in model order -> sum of (4, 4) pseudo-inertias in its frame, and of their magnitudes."""
    place: dict[str, tuple[str, Vector]] = {tree.root_link: (tree.root_link, np.eye(4))}
    sums = {tree.root_link: (np.zeros((4, 4)), np.zeros((4, 4)))}
    for name in ("", *tree.walk()):
        link = child_of(tree.joints[name]) if name else tree.root_link
        if name and kind_of(tree.joints[name]) in MOVING:
            place[link] = (link, np.eye(4))
            sums[link] = (np.zeros((4, 4)), np.zeros((4, 4)))
        elif name:
            body, transform = place[parent_of(tree.joints[name])]
            place[link] = (body, times(transform, _transform(tree, name)))
        body, transform = place[link]
        moments = _second_moments(bodies[link].mass, bodies[link].com, bodies[link].inertia)
        far = np.abs(transform) @ np.abs(moments) @ np.abs(transform).T
        sums[body] = (sums[body][0] + times(times(transform, moments), transform.T), sums[body][1] + far)
    return sums


def _levels(scale: Vector) -> Vector:
    """Magnitudes by kind: a component that is zero by symmetry has the round-off of the others."""
    out = np.empty((4, 4))
    out[:3, :3] = np.max(scale[:3, :3])
    out[:3, 3] = out[3, :3] = np.max(scale[:3, 3])
    out[3, 3] = scale[3, 3]
    return out


def _second_moments(mass: float, com: Vector, inertia: Vector) -> Vector:
    """The (4, 4) pseudo-inertia about the frame's origin."""
    out = np.empty((4, 4))
    out[:3, :3] = 0.5 * np.trace(inertia) * np.eye(3) - inertia + mass * np.outer(com, com)
    out[:3, 3] = out[3, :3] = mass * com
    out[3, 3] = mass
    return out


def _transform(tree: Tree, name: str) -> Vector:
    origin = tree.joints[name].find("origin")
    roll, pitch, yaw = numbers(origin, "rpy", "0 0 0", f"joint {name}").tolist()
    out = np.eye(4)
    for axis, angle in ((2, yaw), (1, pitch), (0, roll)):
        turn = np.eye(3)
        i, j = ((1, 2), (2, 0), (0, 1))[axis]
        sine, turn[i, i] = sincos(angle)
        turn[j, j], turn[j, i], turn[i, j] = turn[i, i], sine, -sine
        out[:3, :3] = times(out[:3, :3], turn)
    out[:3, 3] = numbers(origin, "xyz", "0 0 0", f"joint {name}")
    return out
