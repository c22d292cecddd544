"""The forces of a grasp: springs, dampers, and a torsion that slips."""

from __future__ import annotations

from dataclasses import dataclass

from space_robot_sim.grasp.spec import GraspSpec


@dataclass(frozen=True, slots=True)
class GraspForces:
    """Efforts [N, N, N m] at the three joints of the grasp, and how the bristle stretches [rad/s]."""

    x: float
    y: float
    torque: float
    bristle_rate: float


class Grasp:
    """Force -k d - c d' in each direction; torque -(kth b + d b') of a bristle b that cannot stretch beyond Tc / kth.

    The bristle is stretched by the relative rate w and slips the more the closer it is to its end,

        b' = w - |w| kth b / Tc,

    so that |kth b| never exceeds the slip torque Tc, and the grasp keeps the angle it has slipped to.

    Attributes:
        spec: its numbers.

    Reference: Dahl, "A Solid Friction Model", Aerospace Corp. TOR-158(3107-18), 1968.
    """

    def __init__(self, spec: GraspSpec) -> None:
        self.spec = spec
        self._k, self._c = spec.stiffness, spec.damping
        self._kth, self._d, self._slip = spec.torsional_stiffness, spec.torsional_damping, spec.slip_torque

    def forces(self, x: float, y: float, x_rate: float, y_rate: float, rate: float, bristle: float) -> GraspForces:
        """Return the forces at offsets [m], their rates [m/s], the relative rate [rad/s] and the bristle [rad]."""
        stretch = rate - abs(rate) * self._kth * bristle / self._slip
        return GraspForces(
            -self._k * x - self._c * x_rate,
            -self._k * y - self._c * y_rate,
            -self._kth * bristle - self._d * stretch,
            stretch,
        )

    def stored(self, x: float, y: float, bristle: float) -> float:
        """Return the elastic energy [J]."""
        return 0.5 * (self._k * (x * x + y * y) + self._kth * bristle * bristle)
