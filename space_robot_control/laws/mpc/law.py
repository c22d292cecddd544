"""Linear MPC, a baseline: the regulator's problem over a horizon, within the limits of the actuators."""

from __future__ import annotations

from functools import cached_property
from types import ModuleType
from typing import ClassVar

import numpy as np
from pydantic import Field

from space_robot_control.laws.base import Blocks
from space_robot_control.laws.compiled import CompiledLaw, Layout
from space_robot_control.laws.gain_range import GainRanges
from space_robot_control.laws.lqr.kernel.design import RegulatorRule
from space_robot_control.laws.lqr.kernel.regulator import DESIGNS
from space_robot_control.laws.lqr.law import Lqr
from space_robot_control.laws.mpc.horizon import Horizon, make_horizon
from space_robot_control.laws.mpc.kernel import answer as kernel
from space_robot_control.laws.mpc.kernel.answer import LIMITED
from space_robot_control.laws.mpc.limits import HorizonLimits
from space_robot_control.laws.mpc.solver import check_installed, solve
from space_robot_description.kernel.context import Context, context_of
from space_robot_description.robot import Robot
from space_robot_msgs_py.interfaces import Reference, RobotState, Vector


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
    _kernel: ClassVar[ModuleType] = kernel

    def __init__(self, robot: Robot, control_period: float, gains: Gains | None = None) -> None:
        check_installed()
        super().__init__(robot, control_period, gains)

    @cached_property
    def _limits(self) -> HorizonLimits:
        return HorizonLimits(self.robot, self._effort, self._periods())

    def retune(self, gains: Lqr.Gains) -> None:
        """Go on with other accepted errors, from the next update on."""
        super().retune(gains)
        self._horizon: tuple[int, Horizon] | None = None

    def reset(self) -> None:
        """Forget the posture."""
        super().reset()
        self._horizon = None

    def compiled(self) -> CompiledLaw:
        """The law for compiled runs, as far as no limit is met."""
        return super().compiled()

    def compute(self, state: RobotState, reference: Reference) -> tuple[Vector, Blocks]:
        """Return u and the telemetry listed at the class.

        Raises:
            ControlError: as of ``Lqr``, or the solver has no answer.
        """
        status, u, row = self._answered(state, reference)
        if status == LIMITED:
            self._solve(u, row)
        return u, self._row.blocks(row)

    def _solve(self, u: Vector, row: Vector) -> None:
        """Write u (6+n,), the feed-forward so far, and the row: the first of the inputs that cost least."""
        horizon, limits, memory, m = self._horizon_of(), self._limits, self._memory, self._effort.size
        low, high, *slab = limits.bounds(u)
        slope = horizon.slope @ memory.x
        z, iterations = solve(horizon.hessian, slope, (low, high), limits.rows, (slab[0], slab[1]))
        feedback = self._effort * z[:m]
        u[self._first :] += feedback
        errors = memory.configuration, memory.velocity
        row[:] = np.concatenate([*errors, feedback, [memory.counts[DESIGNS], 1.0, iterations]])

    def _horizon_of(self) -> Horizon:
        """Made once per posture."""
        designs = int(self._memory.counts[DESIGNS])
        if self._horizon is None or self._horizon[0] != designs:
            self._horizon = designs, make_horizon(self.design, self._periods())
        return self._horizon[1]

    def _periods(self) -> int:
        return self.gains.horizon

    def _telemetry_layout(self) -> Layout:
        found = super()._telemetry_layout()
        return Layout((*found.labels, "limited", "iterations"), (*found.sizes, 1, 1))

    def _context_of(self, rule: RegulatorRule) -> Context:
        values = kernel.PredictiveContext(rule, self._memory, self.model.arrays, self._limits.rule)
        return context_of(values, kernel.keep)
