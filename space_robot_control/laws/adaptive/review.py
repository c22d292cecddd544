"""Review of the adaptive law before a run: is the sampled loop stable along this path, and for which gains."""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, degrees, inf, radians

import numpy as np

from space_robot_control.laws.adaptive.euler_coordinates import PITCH, euler_state
from space_robot_control.laws.adaptive.gains import AdaptiveGains
from space_robot_control.laws.adaptive.regressor import Regressor
from space_robot_control.laws.base import Review
from space_robot_control.sampled_stability import stable_lambda
from space_robot_description.robot import Robot
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Reference, Vector

PERIODS = (0.1, 0.25, 0.5, 1.0)  # [s] of the table
KAPPAS = (0.5, 1.0, 2.0)


class AdaptiveReview:
    """The rule of ``stable_lambda`` with the nominal robot.

    Args:
        robot: the NOMINAL robot.
        regressor: its linear separation.
        gains: of the law.
        control_period: [s].
    """

    def __init__(self, robot: Robot, regressor: Regressor, gains: AdaptiveGains, control_period: float) -> None:
        self._free = robot.base_mode == "free_floating"
        self._regressor, self._gains, self._period = regressor, gains, control_period
        values = gains.lambda_.values(robot, "controller.gains.lambda")[3 if self._free else 0 :]
        self._lowest, self._highest = float(values.min()), float(values.max())

    def along(self, path: Sequence[Reference]) -> Review:
        """Judge the gains along a path that begins where the robot starts.

        Raises:
            SpecError: the path comes near the singularity of Euler angles.
        """
        growth = self._growth([self._coordinates(point) for point in path])
        if growth == inf:
            return Review(warnings=("the nominal mass matrix is not positive definite along the path",))
        decay = self._gains.kappa * growth
        low, high = stable_lambda(self._period, decay, on=self._gains.lambda_on, lead=self._gains.lead)
        inside = low < self._lowest and self._highest < high
        allowed = f"{low:.3g} < Lambda < {high:.3g}" if high > low else "no Lambda"
        loop = f"sampled loop at T = {self._period:g} s: lambda_max(M^-1 K_D) = {decay:.3g} along the path"
        facts = (f"{loop}, stable for {allowed}", *(self._row(period, growth) for period in PERIODS))
        if inside:
            return Review(facts)
        return Review(
            facts,
            (
                f"the sampled loop is unstable: Lambda = {self._lambda_text()} with kappa = {self._gains.kappa:g} and "
                f"T = {self._period:g} s, stable for {allowed}",
            ),
        )

    def _lambda_text(self) -> str:
        one = self._lowest == self._highest
        return f"{self._lowest:g}" if one else f"{self._lowest:g} to {self._highest:g}"

    def _row(self, period: float, growth: float) -> str:
        cells = []
        for kappa in KAPPAS:
            low, high = stable_lambda(period, kappa * growth, on=self._gains.lambda_on, lead=self._gains.lead)
            bounds = f"{low:.3g}..{high:.3g}" if high > low else "none"
            cells.append(f"kappa {kappa:g}: {bounds}")
        return f"  T = {period:<4g} s: stable Lambda at " + ", ".join(cells)

    def _growth(self, points: list[Vector]) -> float:
        """Largest lambda_max(M(x)^-1 M(x_0)) along the path; infinite where M is not positive definite."""
        matrix = self._regressor.reduced_mass_matrix if self._free else self._regressor.mass_matrix
        start = matrix(points[0])
        largest = 0.0
        for x in points:
            try:
                root = np.linalg.cholesky(matrix(x))
            except np.linalg.LinAlgError:
                return inf
            half = np.linalg.solve(root, start)
            largest = max(largest, float(np.linalg.eigvalsh(np.linalg.solve(root, half.T))[-1]))
        return largest

    def _coordinates(self, point: Reference) -> Vector:
        x, _ = euler_state(point)
        pitch, limit = float(x[PITCH]), self._gains.pitch_limit_deg
        if abs(pitch) > radians(limit):
            raise SpecError(
                f"the path comes near the singularity of Euler angles (cos(pitch) = {cos(pitch):.3g})",
                key="controller.law: adaptive",
                value=f"pitch {degrees(pitch):.6g} deg at {point.stamp / 1e9:g} s",
                accepted=f"-{limit:g} to {limit:g} deg, or another law",
            )
        return x
