"""Modes of a flexible robot about a posture in which every spring is relaxed."""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np

from space_robot_description.mass_matrix import mass_matrix
from space_robot_msgs_py.interfaces import Vector
from space_robot_sim.flexible.springs import DAMPING, ROTOR, STIFFNESS

# Of the fastest eigenvalue; below are the drifts of the free robot, zeros that round-off splits by its root.
DRIFT = 1e-6


def linear_rates(model: Any, joints: Vector, springs: Vector) -> Vector:
    """Eigenvalues [1/s] of the free robot's small motions, base and unsprung joints drifting; of a rigid one zeros.

    M x'' + D x' + K x = 0 over the base, all joints and the motors behind their gears.

    Args:
        model: ``pin.Model`` with the hidden joints.
        joints: (N,) positions.
        springs: (N, 5) see `kernel.flexible`.

    Returns:
        (2 (6+N+k),) complex.
    """
    gears = np.flatnonzero(springs[:, ROTOR]).tolist()
    size, first = model.nv + len(gears), model.nv
    mass, stiffness, damping = (np.zeros((size, size)) for _ in range(3))
    q = np.zeros(model.nq)
    q[6], q[7:] = 1.0, joints
    mass[:first, :first] = mass_matrix(model, q)
    for joint, row in enumerate(springs):
        pull = np.zeros(size)
        pull[6 + joint] = 1.0
        if joint in gears:
            motor = first + gears.index(joint)
            mass[motor, motor], pull[motor] = row[ROTOR], -1.0
        stiffness += row[STIFFNESS] * np.outer(pull, pull)
        damping += row[DAMPING] * np.outer(pull, pull)
    back = np.linalg.solve(mass, np.hstack([-stiffness, -damping]))
    found: Vector = np.linalg.eigvals(np.vstack([np.eye(size, 2 * size, size), back]))
    return found


def mode_frequencies(rates: Vector) -> tuple[float, ...]:
    """Frequencies [Hz] of the oscillations among eigenvalues, damped ones as they are seen, slowest first."""
    seen = rates[rates.imag > DRIFT * np.max(np.abs(rates), initial=0.0)]
    return tuple(sorted((seen.imag / (2.0 * pi)).tolist()))
