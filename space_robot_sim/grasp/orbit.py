"""Central gravity in the frame of a virtual point on a circular orbit, its axes parallel to the inertial ones."""

from __future__ import annotations

from math import sqrt

import numpy as np

from space_robot_description.rotations import Three
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.elementary import sincos
from space_robot_sim.grasp.spec import OrbitSpec


class Orbit:
    """What is left of gravity when the frame falls with the virtual point: -mu (R + d)/|R + d|^3 + mu R/|R|^3.

    R is the place of the virtual point, d the position in its frame. With q = d.(d + 2 R)/R^2 this is
    -(mu/R^3) (d (1+q)^(-3/2) + R ((1+q)^(-3/2) - 1)), which loses no digits for small d.

    Reference: Song et al. (2023), (1) with its sign corrected and the frame C_L of Fig. 2; Battin, "An Introduction to
    the Mathematics and Methods of Astrodynamics", 1999, sec. 8.1.
    """

    def __init__(self, spec: OrbitSpec) -> None:
        self._radius, self._rate = spec.radius, sqrt(spec.mu / (spec.radius * spec.radius * spec.radius))

    @property
    def rate(self) -> float:
        """Mean motion of the virtual point [rad/s]."""
        return self._rate

    def acceleration(self, t: float, d: Three) -> Three:
        """Return the acceleration [m/s2] at a time [s] and a place d [m], inertial axes."""
        r, place = self._radius, self._place(t)
        q = sum(a * (a + 2.0 * b) for a, b in zip(d, place, strict=True)) / (r * r)
        s = sqrt(1.0 + q)
        less = -q / (1.0 + s) * (1.0 + s + s * s) / (s * s * s)
        n2 = self._rate * self._rate
        x, y, z = (-n2 * (a * (1.0 + less) + b * less) for a, b in zip(d, place, strict=True))
        return x, y, z

    def gradient_torque(self, t: float, d: Vector, turns: Vector, inertia: Vector) -> Vector:
        """Return the torques (k, 3) 3 mu/r^3 u x I u [N m] on bodies about their centres of mass, in their axes.

        Gravity is weaker at a body's far side: u is the direction from the centre of attraction, r the distance.

        Args:
            t: [s].
            d: (k, 3) their centres of mass [m].
            turns: (k, 3, 3) from their axes to the inertial ones.
            inertia: (k, 3, 3) about the centres, in their axes [kg m2].

        Reference: Wertz (ed.), "Spacecraft Attitude Determination and Control", 1978, (17-30).
        """
        away = d + np.array(self._place(t))
        r2 = np.sum(away * away, axis=1)
        u = np.einsum("kji,kj->ki", turns, away / np.sqrt(r2)[:, None])
        near = self._radius / np.sqrt(r2)
        strength = 3.0 * self._rate * self._rate * near * near * near
        torques: Vector = strength[:, None] * crosses(u, np.einsum("kij,kj->ki", inertia, u))
        return torques

    def _place(self, t: float) -> Three:
        """Where the virtual point is [m]."""
        sine, cosine = sincos(self._rate * t)
        return self._radius * cosine, self._radius * sine, 0.0


def crosses(a: Vector, b: Vector) -> Vector:
    """(k, 3) cross products of rows; np.cross takes five times as long for so few."""
    turned: Vector = a[:, [1, 2, 0]] * b[:, [2, 0, 1]] - a[:, [2, 0, 1]] * b[:, [1, 2, 0]]
    return turned
