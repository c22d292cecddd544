"""A law with memory: PID on base attitude and joints. What it remembers it forgets in `reset`.

space-robot check liu2023/fig08 --set controller.law=examples/pid_law.py:Pid --set controller.gains={}
python examples/pid_law.py
"""

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat

import space_robot as sr


class Pid(sr.Law):
    """u = M(q) (wn^2 e + 2 wn e' + ki int e dt) for base rotation and joints; the base is not pushed."""

    class Gains(sr.Law.Gains):
        """Two numbers."""

        bandwidth: PositiveFloat = Field(default=0.8, description="natural frequency wn [rad/s]")
        integral: NonNegativeFloat = Field(default=0.02, description="ki [1/s^3]")

    name = "pid"
    gains: Gains

    def __init__(self, robot: sr.Robot, control_period: float, gains: Gains | None = None) -> None:
        super().__init__(robot, control_period, gains)
        self.model, self.integral = sr.NominalModel(robot), np.zeros(6 + robot.n)

    def reset(self) -> None:
        """Without this a second run would begin with the integral of the first; `check` warns of it."""
        super().reset()
        self.integral = np.zeros_like(self.integral)

    def compute(self, state: sr.RobotState, reference: sr.Reference) -> tuple[sr.Vector, sr.Blocks]:
        """Return the generalised force [N, N m] and what goes into the log."""
        errors, wn = sr.tracking_errors(state, reference), self.gains.bandwidth
        self.integral = self.integral + errors.configuration * self.control_period
        wanted = wn * wn * errors.configuration + 2.0 * wn * errors.velocity + self.gains.integral * self.integral
        u = np.zeros(6 + self.n)
        u[3:] = self.model.reduced_mass_matrix(state.q) @ wanted[3:]
        return u, {**sr.error_blocks(errors), "integral": self.integral[3:]}


def main() -> None:
    """A leak that pushes all the time and that no law knows: what the integral is for."""
    leak = {"kind": "wrench_pulse", "torque": [0, 0, 0.02], "at": 1.0}
    rough = {"controller.law": Pid, "faults": [leak], "expect": {}, "duration": 60.0}
    for gain in (0.0, 0.02):
        run = sr.run("liu2023/fig08", rough | {"controller.gains.integral": gain})
        print(f"ki = {gain}: yaw is off by {run.metrics.flat()['base/yaw.final_error']:.3f} deg")


if __name__ == "__main__":
    main()
