"""A law of your own, complete: attitude and joints by a PD with a constant inertia, and what the desired motion needs.

    space-robot run liu2023/fig08 --set controller.law=examples/my_law.py:PdPlus

Unlike computed torque it knows the inertia of one configuration only, and its feed-forward is that of the desired
motion, whatever the measured state is. It never pushes the base.
"""

import numpy as np
from pydantic import Field, PositiveFloat

from space_robot_control.laws import Blocks, Law
from space_robot_control.laws.dynamics import NominalModel
from space_robot_control.laws.tracking import error_blocks, tracking_errors
from space_robot_description.robot import Robot
from space_robot_msgs_py.interfaces import Reference, RobotState, Vector


class PdPlus(Law):
    """u = u_d + M_home (wn^2 e + 2 wn e') for base rotation and joints, u_d from the nominal inverse dynamics."""

    class Gains(Law.Gains):
        """One number."""

        bandwidth: PositiveFloat = Field(default=0.5, description="natural frequency wn [rad/s]")

    name = "pd_plus"
    gains: Gains

    def __init__(self, robot: Robot, control_period: float, gains: Gains | None = None) -> None:
        super().__init__(robot, control_period, gains)
        self.model = NominalModel(robot)
        home = np.concatenate([np.zeros(6), [1.0], robot.home])
        self.inertia = self.model.reduced_mass_matrix(home)

    def compute(self, state: RobotState, reference: Reference) -> tuple[Vector, Blocks]:
        """Return the generalised force and what to log."""
        errors, wn = tracking_errors(state, reference), self.gains.bandwidth
        a = self.model.free_floating_acceleration(reference.q, reference.v, reference.a)
        u = self.model.inverse_dynamics(reference.q, reference.v, a)
        feedback = wn * wn * errors.configuration + 2.0 * wn * errors.velocity
        u[:3], u[3:] = 0.0, u[3:] + self.inertia @ feedback[3:]
        return u, {**error_blocks(errors), "feedback": feedback[3:]}
