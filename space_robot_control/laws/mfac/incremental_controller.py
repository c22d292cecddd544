"""The incremental law (16): from an error and a pseudo-partial derivative to an input within its limits."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np

from space_robot_control.laws.mfac.pseudo_gradient import PseudoGradient
from space_robot_msgs_py.errors import ControlError, SpecError
from space_robot_msgs_py.interfaces import Vector


@dataclass(frozen=True, eq=False, slots=True)
class Weights:
    """The numbers of the law.

    Attributes:
        rho: rho_1 .. rho_{Ly+Lu} [-]; rho_{Ly+1} weighs the error and may be (m,), one per output.
        kappa: lambda = kappa phi^2, free of units; as a matrix phi^T kappa phi, one number or (m,); 0: dead-beat.
        control: lambda itself, in the squared units of phi; the two add up.
    """

    rho: tuple[float | Vector, ...]
    kappa: float | Vector = 0.0
    control: float = 0.0


class IncrementalController:
    """u(k) = u(k-1) + (lambda + phi^T phi)^-1 phi^T [rho (y* - y) - sum rho_i phi_i dy - sum rho_i phi_i du].

    phi = phi_{Ly+1} is the derivative by the input; the first sum runs over the Ly increments of the outputs, the
    second over the Lu - 1 earlier increments of the input.

    The increment is kept in two parts: the response to the error sums up to an integral, the response to increments to
    a proportional part. At its limit a channel freezes the integral that would push it further and keeps the
    proportional part, so that it leaves the limit when the outputs demand it and not when an integral has unwound.

    Args:
        weights: rho, kappa, control.
        output_order: Ly.
        input_order: Lu.
        limit: (m,) largest |u|, may be infinite.

    Raises:
        SpecError: the number of rho is not Ly + Lu.

    Reference: Song et al. (2023), (16), index of the third sum corrected.

    lambda = kappa phi^T phi vanishes with phi, so that in a direction in which phi is nearly singular any kappa is
    dead-beat on noise. There lambda has a floor: it grows by as much as the square of the smallest singular value of
    phi is below that of ``gradient.least_gain``.

    Deviations from the paper: lambda relative to phi, and its floor; the limit and its anti-windup.
    """

    def __init__(self, weights: Weights, output_order: int, input_order: int, limit: Vector) -> None:
        if len(weights.rho) != output_order + input_order:
            accepted = f"{output_order + input_order} numbers, Ly + Lu"
            raise SpecError("wrong number of weights", key="rho", value=len(weights.rho), accepted=accepted)
        self._weights, self._orders, self._limit = weights, (output_order, input_order), np.array(limit)
        self.reset()

    def reset(self) -> None:
        """Forget the past."""
        zero, (ly, lu) = np.zeros(self._limit.size), self._orders
        self._dy, self._du = deque([zero] * ly, maxlen=ly), deque([zero] * lu, maxlen=lu)
        self._proportional, self._integral, self._command = zero, zero, zero
        self.saturated = np.zeros(zero.size, dtype=bool)

    def set_weights(self, weights: Weights) -> None:
        """Go on with other rho, kappa or control weight; the orders stay."""
        self._weights = weights

    @property
    def command(self) -> Vector:
        """(m,) u(k), within the limits."""
        return self._command

    @property
    def increment(self) -> Vector:
        """(m,) du(k), between commands within the limits."""
        return self._du[0]

    def update(self, error: Vector, dy: Vector, gradient: PseudoGradient) -> Vector:
        """Return u(k) (m,).

        Args:
            error: (m,) y*(k+1) - y(k).
            dy: (m,) y(k) - y(k-1).
            gradient: the present Phi.

        Raises:
            ControlError: lambda + phi^T phi has no inverse, or the result is not finite.
        """
        self._dy.appendleft(np.array(dy))
        ly, rho = self._orders[0], self._weights.rho
        past: Vector = np.zeros(error.size)
        for i in range(ly):
            past = past + np.multiply(rho[i], gradient.block(i) @ self._dy[i])
        for i in range(1, self._orders[1]):
            past = past + np.multiply(rho[ly + i], gradient.block(ly + i) @ self._du[i - 1])
        step = self._solve(gradient.block(ly), gradient.least_gain, np.column_stack([rho[ly] * error, -past]))
        self._accumulate(step[:, 0], step[:, 1])
        return self._command

    def _solve(self, phi: Vector, least: float, change: Vector) -> Vector:
        share = np.broadcast_to(1.0 + np.asarray(self._weights.kappa), self._limit.shape)
        weighted = (phi.T * share) @ phi + self._weights.control * np.eye(self._limit.size)
        if (smallest := float(np.linalg.svd(phi, compute_uv=False)[-1])) < least:
            weighted += (least**2 - smallest**2) * np.eye(self._limit.size)
        try:
            step: Vector = np.array(np.linalg.solve(weighted, phi.T @ change))
        except np.linalg.LinAlgError:
            raise ControlError("lambda + phi^T phi has no inverse", key="phi", value=phi.tolist()) from None
        if not np.isfinite(step).all():
            raise ControlError("not a finite number", key="du", value=step.tolist())
        return step

    def _accumulate(self, integral: Vector, proportional: Vector) -> None:
        self._proportional = self._proportional + proportional
        desired = self._proportional + self._integral + integral
        outside = np.abs(desired) > self._limit
        frozen = outside & (np.sign(integral) == np.sign(desired))
        self._integral = self._integral + np.where(frozen, 0.0, integral)
        command = np.clip(self._proportional + self._integral, -self._limit, self._limit)
        self._du.appendleft(command - self._command)
        self._command, self.saturated = command, outside


def weights_of(
    output_order: int, input_order: int, error: float | Vector, kappa: float | Vector, control: float
) -> Weights:
    """Weights that are 1 for every past increment and ``error`` for y* - y."""
    return Weights((*[1.0] * output_order, error, *[1.0] * (input_order - 1)), kappa, control)
