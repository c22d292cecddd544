"""Linear MPC, a baseline: the regulator's problem over a horizon, within the limits of the actuators."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field

from space_robot_control.laws.base import Blocks
from space_robot_control.laws.gain_range import GainRanges
from space_robot_control.laws.lqr.law import Lqr
from space_robot_control.laws.lqr.linear_model import Design
from space_robot_control.laws.mpc.horizon import Horizon, make_horizon
from space_robot_control.laws.mpc.limits import HorizonLimits
from space_robot_control.laws.mpc.solver import check_installed, solve
from space_robot_description.robot import Robot
from space_robot_msgs_py.interfaces import Vector


class LinearMpc(Lqr):
    """u = M0 a_ff + c0 + omega x h + w_0, w_0 to w_{N-1} the least of the costs of ``Lqr`` such that every u fits.

    Model, accepted errors and postures are those of ``Lqr``; its cost X stands for all periods after the N-th, so that
    where no limit is met the command is that of ``Lqr`` for every N. The feed-forward of now stands for the whole
    horizon. Limits are those of ``CommandLimits``: forces, torques and efforts, and the torque of every wheel.

    Where the answer without limits fits it is taken; only else a solver is called, from the beginning each time. A
    solver that did not converge ends the run with an error.

    Args:
        robot: the NOMINAL robot.
        control_period: T [s].
        gains: those of ``Lqr``, and horizon.

    Raises:
        SpecError: as ``Lqr``; or piqp is not installed.

    The equations on one screen: ``reference.py``.

    Reference: Mayne, Rawlings, Rao, Scokaert, "Constrained model predictive control: stability and optimality",
    Automatica 36, 2000; Schwan, Jiang, Kuhn, Jones, "PIQP: a proximal interior-point quadratic programming solver",
    CDC 2023.
    """

    class Gains(Lqr.Gains):
        """Gains of linear MPC."""

        horizon: int = Field(default=10, ge=1, le=50, description="N, periods that are looked ahead [-]")

    name = "mpc"
    gain_ranges: ClassVar[GainRanges] = Lqr.gain_ranges
    telemetry_fields = Lqr.telemetry_fields | {
        "limited": "1 where a limit is met within the horizon and the solver was called [-]",
        "iterations": "of the solver [-]",
    }
    gains: Gains

    def __init__(self, robot: Robot, control_period: float, gains: Gains | None = None) -> None:
        check_installed()
        super().__init__(robot, control_period, gains)
        self._limits = HorizonLimits(robot, self._effort, self.gains.horizon)
        self._horizon: tuple[Design, Horizon] | None = None

    def _feedback(self, design: Design, x: Vector, feedforward: Vector) -> tuple[Vector, Blocks]:
        """The first of the inputs that cost least."""
        horizon, limits = self._horizon_of(design), self._limits
        z, iterations = horizon.free @ x, 0
        low, high, *slab = limits.bounds(feedforward)
        product = limits.rows @ z
        fits = bool(((low <= z) & (z <= high)).all() and ((slab[0] <= product) & (product <= slab[1])).all())
        if not fits:
            z, iterations = solve(horizon.hessian, horizon.slope @ x, (low, high), limits.rows, (slab[0], slab[1]))
        return self._effort * z[: self._effort.size], {"limited": float(not fits), "iterations": iterations}

    def _horizon_of(self, design: Design) -> Horizon:
        """Made once per posture."""
        if self._horizon is None or self._horizon[0] is not design:
            self._horizon = design, make_horizon(design, self.gains.horizon)
        return self._horizon[1]
