"""A law of your own, complete: PD on base attitude and joints, and what the desired motion needs.

    space-robot run liu2023/fig08 --set controller.law=examples/my_law.py:PdPlus --set controller.gains={}

Unlike computed torque its inertia and its feed-forward are those of the desired motion, whatever the measured state is:
they could be computed before the run. It never pushes the base.
"""

from typing import ClassVar

from pydantic import Field, PositiveFloat

from space_robot import (
    Blocks,
    GainRange,
    Law,
    NominalModel,
    Reference,
    Robot,
    RobotState,
    Vector,
    error_blocks,
    tracking_errors,
)


class PdPlus(Law):
    """u = u_d + M(q_d) (wn^2 e + 2 wn e') for base rotation and joints, u_d from the nominal inverse dynamics."""

    class Gains(Law.Gains):
        """One number."""

        bandwidth: PositiveFloat = Field(default=1.0, description="natural frequency wn [rad/s]")

    name = "pd_plus"
    gain_ranges: ClassVar = {"bandwidth": GainRange(0.02, 2.0)}  # [rad/s], what `space-robot tune` may search
    gains: Gains

    def __init__(self, robot: Robot, control_period: float, gains: Gains | None = None) -> None:
        super().__init__(robot, control_period, gains)
        self.model = NominalModel(robot)

    def compute(self, state: RobotState, reference: Reference) -> tuple[Vector, Blocks]:
        """Return the generalised force and what to log."""
        errors, wn = tracking_errors(state, reference), self.gains.bandwidth
        a = self.model.free_floating_acceleration(reference.q, reference.v, reference.a)
        u = self.model.inverse_dynamics(reference.q, reference.v, a)
        feedback = wn * wn * errors.configuration + 2.0 * wn * errors.velocity
        u[3:] += self.model.reduced_mass_matrix(reference.q) @ feedback[3:]
        u[:3] = 0.0
        return u, {**error_blocks(errors), "feedback": feedback[3:]}
