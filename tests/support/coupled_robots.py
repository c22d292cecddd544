"""Robots of which joints follow others, beside the same ones in which every joint has its coordinate."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from tests.support.robots import random_model

Vector = npt.NDArray[np.float64]


class Coupled(NamedTuple):
    """A model with followers, and what it is made of: q_N = spread q + shift, v_N = G v of the joints of ``full``."""

    model: Any
    full: Any
    G: Vector
    shift: Vector

    def joints(self, q: Vector) -> Vector:
        """(7+N,) configuration of ``full``."""
        return np.concatenate([q[:7], self.G[6:, 6:] @ q[7:] + self.shift])

    def mass_matrix(self, q: Vector) -> Vector:
        """G^T M_N G of the full model, column by column: ``pin.crba`` wants bodies depth first."""
        zero = np.zeros(self.G.shape[1])
        return np.array([self.forces(q, zero, unit) for unit in np.eye(zero.size)])

    def forces(self, q: Vector, v: Vector, a: Vector) -> Vector:
        """G^T of the inverse dynamics of the full model."""
        return self.G.T @ pin.rnea(self.full, self.full.createData(), self.joints(q), self.G @ v, self.G @ a)


def random_coupled(rng: np.random.Generator, joints: int, *, serial: bool = False) -> Coupled:
    """A random tree of which about a third of the joints follow others, of whatever kind."""
    full = random_model(rng, joints, serial=serial)
    followers: dict[int, tuple[int, float, float]] = {}
    for joint in range(1, joints):
        if (joint == joints - 1 and not followers) or rng.random() < 0.35:
            masters = [one for one in range(joint) if one not in followers]
            followers[joint] = (int(rng.choice(masters)), float(rng.uniform(-2.0, 2.0)), float(rng.normal()) * 0.2)
    free = [joint for joint in range(joints) if joint not in followers]
    G, shift = np.zeros((6 + joints, 6 + len(free))), np.zeros(joints)
    G[:6, :6] = np.eye(6)
    for joint in range(joints):
        master, factor, shift[joint] = followers.get(joint, (joint, 1.0, 0.0))
        G[6 + joint, 6 + free.index(master)] = factor
    model = full
    for joint, (master, factor, offset) in followers.items():
        model = pin.transformJointIntoMimic(model, master + 2, joint + 2, factor, offset)
    return Coupled(model, full, G, shift)
