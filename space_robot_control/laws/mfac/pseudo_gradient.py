"""The pseudo-partial derivative Phi: a local linear model between increments, and its estimator."""

from __future__ import annotations

import numpy as np

from space_robot_control.laws.mfac.kernel.gradient import (
    FLOOR,
    LEAST,
    GradientRule,
    foresee,
    gradient_memory,
    learn,
    pass_over,
)
from space_robot_description.kernel.dense import smallest_singular_value
from space_robot_description.kernel.linear import inverse
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Vector


class PseudoGradient:
    """Full-form dynamic linearisation dy(k+1) = Phi(k) dH(k) and its projection estimator.

    With m outputs and inputs, dH(k) = [dy(k) .. dy(k-Ly+1), du(k) .. du(k-Lu+1)] and Phi = [phi_1 .. phi_{Ly+Lu}], each
    block (m, m); one channel is the case m = 1. The estimate is corrected along the regressor that caused the error,

        Phi(k) = Phi(k-1) + sigma (dy(k) - Phi(k-1) dH(k-1)) dH(k-1)^T / (beta + |dH(k-1)|^2),

    and is reset to Phi(1) where phi_{Ly+1} loses its direction: where an entry of diag(phi phi(1)^-1) falls below
    ``floor``; for one channel, where it changes sign or becomes tiny.

    Args:
        first: (m, m (Ly+Lu)) Phi(1), in the units of outputs and inputs.
        output_order: Ly, at least 1.
        input_order: Lu, at least 1.
        sigma: step size in [0, 2]; 0 freezes the estimate.
        beta: > 0, in the squared units of dH.
        floor: share of Phi(1) below which the estimate is reset, in (0, 1).

    Attributes:
        rule: the numbers, for kernels.
        memory: what it remembers, for kernels.

    Raises:
        SpecError: sizes that do not fit, or phi_{Ly+1}(1) without an inverse.

    Reference: Song et al. (2023), (15), (17); Hou and Jin, "Model Free Adaptive Control", 2013, ch. 3 (reset).

    Deviations from the paper: the bracket of (17) that is missing in print is there; the reset is not printed.
    """

    def __init__(
        self, first: Vector, output_order: int, input_order: int, *, sigma: float, beta: float, floor: float = 0.1
    ) -> None:
        m = first.shape[0] if first.ndim == 2 else 0
        if m == 0 or first.shape[1] != m * (output_order + input_order) or min(output_order, input_order) < 1:
            raise SpecError("sizes do not fit", key="first", value=first.shape, accepted="(m, m (Ly + Lu))")
        self.rule = GradientRule(output_order, input_order, float(sigma), float(beta))
        self.memory = gradient_memory(m, output_order, input_order)
        self._gain, self._floor = slice(m * output_order, m * (output_order + 1)), floor
        self.begin(first)

    def begin(self, first: Vector) -> None:
        """Forget the past and go on from another Phi(1), of the same size.

        Raises:
            SpecError: phi_{Ly+1}(1) has no inverse.
        """
        gain = first[:, self._gain]
        if not np.isfinite(first).all() or np.linalg.cond(gain) > 1e12:
            raise SpecError("has no inverse", key="first (phi of the input)", value=gain.tolist())
        self.memory.first[:], self.memory.back[:] = first, inverse(gain)
        self.memory.bounds[FLOOR] = self._floor
        self.memory.bounds[LEAST] = self._floor * smallest_singular_value(np.array(gain), np.empty_like(gain))
        self.reset()

    @property
    def outputs(self) -> int:
        """M."""
        return int(self.memory.innovation.size)

    @property
    def estimate(self) -> Vector:
        """(m, m (Ly+Lu)) Phi."""
        return self.memory.estimate

    @property
    def innovation(self) -> Vector:
        """(m,) dy - Phi dH of the last update."""
        return self.memory.innovation

    @property
    def resets(self) -> int:
        """Resets of Phi so far."""
        return int(self.memory.resets[0])

    @property
    def least_gain(self) -> float:
        """``floor`` times the smallest singular value of phi_{Ly+1}(1): weaker responses are not believed."""
        return float(self.memory.bounds[LEAST])

    def block(self, index: int) -> Vector:
        """phi_{index+1}, (m, m)."""
        m = self.outputs
        return self.estimate[:, m * index : m * (index + 1)]

    def reset(self) -> None:
        """Forget the past and return to Phi(1)."""
        self.memory.estimate[:] = self.memory.first
        for array in (self.memory.past, self.memory.innovation, self.memory.resets):
            array[:] = 0

    def update(self, dy: Vector, du: Vector) -> None:
        """Update Phi by one period, (17).

        Args:
            dy: (m,) increment of the outputs over the period that just ended, dy(k).
            du: (m,) increment of the inputs at its beginning, du(k-1).
        """
        learn(self.rule, self.memory, dy, du)

    def predict(self, du: Vector) -> Vector:
        """Return dy(k+1) (m,) that an increment du(k) (m,) of the inputs leads to, Phi(k) dH(k)."""
        dy = np.zeros(self.outputs)
        foresee(self.rule, self.memory, du, dy)
        return dy

    def skip(self, du: Vector) -> None:
        """Pass over a period whose increment of the outputs is not known or not due to ``du``."""
        pass_over(self.rule, self.memory, du)
