"""The incremental law (16): from an error and a pseudo-partial derivative to an input within its limits."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from space_robot_control.kernel.answers import ANSWERED
from space_robot_control.laws.mfac.kernel.increment import SINGULAR, IncrementRule, increment_memory, respond
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

    Attributes:
        rule: the numbers, for kernels.
        memory: what it remembers, for kernels.

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
        m, orders = len(limit), (output_order, input_order)
        numbers = np.zeros((sum(orders), m)), np.zeros(m), np.zeros(1), np.array(limit, dtype=np.float64)
        self.rule, self.memory = IncrementRule(*orders, *numbers), increment_memory(m, *orders)
        self.set_weights(weights)

    def begin(self, weights: Weights, limit: Vector) -> None:
        """Forget the past and go on with other weights and limits (m,); the orders stay."""
        self.set_weights(weights)
        self.rule.limit[:] = limit
        self.reset()

    def reset(self) -> None:
        """Forget the past."""
        memory = self.memory
        for array in (memory.past, memory.proportional, memory.integral, memory.command, memory.saturated):
            array[:] = 0

    def set_weights(self, weights: Weights) -> None:
        """Go on with other rho, kappa or control weight; the orders stay."""
        for row, rho in zip(self.rule.rho, weights.rho, strict=True):
            row[:] = rho
        self.rule.share[:], self.rule.control[:] = 1.0 + np.asarray(weights.kappa), weights.control

    @property
    def command(self) -> Vector:
        """(m,) u(k), within the limits."""
        return self.memory.command.copy()

    @property
    def increment(self) -> Vector:
        """(m,) du(k), between commands within the limits."""
        newest: Vector = self.memory.past[self.rule.outputs]
        return newest.copy()

    @property
    def saturated(self) -> npt.NDArray[np.bool_]:
        """(m,) True where a channel is at its limit."""
        return self.memory.saturated

    def update(self, error: Vector, dy: Vector, gradient: PseudoGradient) -> Vector:
        """Return u(k) (m,).

        Args:
            error: (m,) y*(k+1) - y(k).
            dy: (m,) y(k) - y(k-1).
            gradient: the present Phi.

        Raises:
            ControlError: lambda + phi^T phi has no inverse, or the result is not finite.
        """
        self.check(respond(self.rule, self.memory, gradient.memory, error, dy))
        return self.command

    def check(self, status: int) -> None:
        """Raise what a status of ``kernel.increment.respond`` says.

        Raises:
            ControlError: as for ``update``.
        """
        if status == SINGULAR:
            value = self.memory.phi.tolist()
            raise ControlError("lambda + phi^T phi has no inverse", key="phi", value=value)
        if status != ANSWERED:
            raise ControlError("not a finite number", key="du", value=self.memory.step.T.tolist())


def weights_of(
    output_order: int, input_order: int, error: float | Vector, kappa: float | Vector, control: float
) -> Weights:
    """Weights that are 1 for every past increment and ``error`` for y* - y."""
    return Weights((*[1.0] * output_order, error, *[1.0] * (input_order - 1)), kappa, control)
