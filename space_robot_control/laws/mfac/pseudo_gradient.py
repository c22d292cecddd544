"""The pseudo-partial derivative Phi: a local linear model between increments, and its estimator."""

from __future__ import annotations

from collections import deque

import numpy as np

from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Vector

# A regressor whose squared norm is less carries no information (in the units of outputs and inputs).
MIN_NORM_SQUARED = 1e-12


class PseudoGradient:
    """Full-form dynamic linearisation dy(k+1) = Phi(k) dH(k) and its projection estimator.

    With m outputs and inputs, dH(k) = [dy(k) .. dy(k-Ly+1), du(k) .. du(k-Lu+1)] and Phi = [phi_1 .. phi_{Ly+Lu}], each
    block (m, m); one channel is the case m = 1. The estimate is corrected along the regressor that caused the error,

        Phi(k) = Phi(k-1) + sigma (dy(k) - Phi(k-1) dH(k-1)) dH(k-1)^T / (beta + |dH(k-1)|^2),

    and is reset to Phi(1) where phi_{Ly+1} loses its direction: where an entry of diag(phi phi(1)^-1) falls below
    ``floor``; for one channel, where it changes sign or becomes tiny.

    Attributes:
        least_gain: ``floor`` times the smallest singular value of phi_{Ly+1}(1): weaker responses are not believed.

    Args:
        first: (m, m (Ly+Lu)) Phi(1), in the units of outputs and inputs.
        output_order: Ly, at least 1.
        input_order: Lu, at least 1.
        sigma: step size in [0, 2]; 0 freezes the estimate.
        beta: > 0, in the squared units of dH.
        floor: share of Phi(1) below which the estimate is reset, in (0, 1).

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
        self._first, self._orders = np.array(first), (output_order, input_order)
        self._gain = slice(m * output_order, m * (output_order + 1))
        gain = self._first[:, self._gain]
        if not np.isfinite(first).all() or np.linalg.cond(gain) > 1e12:
            raise SpecError("has no inverse", key="first (phi of the input)", value=gain.tolist())
        self._back = np.linalg.inv(gain)
        self.least_gain = floor * float(np.linalg.svd(gain, compute_uv=False)[-1])
        self._sigma, self._beta, self._floor = sigma, beta, floor
        self.reset()

    @property
    def outputs(self) -> int:
        """M."""
        return int(self._first.shape[0])

    def block(self, index: int) -> Vector:
        """phi_{index+1}, (m, m)."""
        m = self.outputs
        return self.estimate[:, m * index : m * (index + 1)]

    def reset(self) -> None:
        """Forget the past and return to Phi(1)."""
        zero, (ly, lu) = np.zeros(self.outputs), self._orders
        self._dy, self._du = deque([zero] * ly, maxlen=ly), deque([zero] * lu, maxlen=lu)
        self.estimate = self._first.copy()
        self.innovation = zero
        self.resets = 0

    def update(self, dy: Vector, du: Vector) -> None:
        """Update Phi by one period, (17).

        Args:
            dy: (m,) increment of the outputs over the period that just ended, dy(k).
            du: (m,) increment of the inputs at its beginning, du(k-1).
        """
        self._du.appendleft(np.array(du))
        regressor = np.concatenate([*self._dy, *self._du])
        self._dy.appendleft(np.array(dy))
        self.innovation = dy - self.estimate @ regressor
        size = float(regressor @ regressor)
        if self._sigma == 0.0 or size < MIN_NORM_SQUARED:
            return
        self.estimate = self.estimate + self._sigma * np.outer(self.innovation, regressor) / (self._beta + size)
        share = np.einsum("ij,ji->i", self.estimate[:, self._gain], self._back)
        if not np.isfinite(self.estimate).all() or share.min() < self._floor:
            self.estimate = self._first.copy()
            self.resets += 1

    def predict(self, du: Vector) -> Vector:
        """Return dy(k+1) (m,) that an increment du(k) (m,) of the inputs leads to, Phi(k) dH(k)."""
        out: Vector = self.estimate @ np.concatenate([*self._dy, du, *list(self._du)[:-1]])
        return out

    def skip(self, du: Vector) -> None:
        """Pass over a period whose increment of the outputs is not known or not due to ``du``."""
        self._du.appendleft(np.array(du))
        self._dy.appendleft(self._dy[0])
