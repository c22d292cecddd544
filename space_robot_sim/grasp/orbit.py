"""Central gravity in the frame of a virtual point on a circular orbit, its axes parallel to the inertial ones."""

from __future__ import annotations

from math import cos, expm1, log1p, sin, sqrt

from space_robot_description.rotations import Three
from space_robot_sim.grasp.spec import OrbitSpec


class Orbit:
    """What is left of gravity when the frame falls with the virtual point: -mu (R + d)/|R + d|^3 + mu R/|R|^3.

    R is the place of the virtual point, d the position in its frame. With q = d.(d + 2 R)/R^2 this is
    -(mu/R^3) (d (1+q)^(-3/2) + R ((1+q)^(-3/2) - 1)), which loses no digits for small d.

    Reference: Song et al. (2023), (1) with its sign corrected and the frame C_L of Fig. 2; Battin, "An Introduction to
    the Mathematics and Methods of Astrodynamics", 1999, sec. 8.1.
    """

    def __init__(self, spec: OrbitSpec) -> None:
        self._radius, self._rate = spec.radius, sqrt(spec.mu / spec.radius**3)

    @property
    def rate(self) -> float:
        """Mean motion of the virtual point [rad/s]."""
        return self._rate

    def acceleration(self, t: float, d: Three) -> Three:
        """Return the acceleration [m/s2] at a time [s] and a place d [m], inertial axes."""
        r = self._radius
        place = (r * cos(self._rate * t), r * sin(self._rate * t), 0.0)
        q = sum(a * (a + 2.0 * b) for a, b in zip(d, place, strict=True)) / (r * r)
        less = expm1(-1.5 * log1p(q))
        n2 = self._rate * self._rate
        x, y, z = (-n2 * (a * (1.0 + less) + b * less) for a, b in zip(d, place, strict=True))
        return x, y, z
