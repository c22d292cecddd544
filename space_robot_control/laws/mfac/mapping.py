"""Phi(1) of outputs that accelerate with their inputs, in the units the law works in (19)."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from space_robot_msgs_py.interfaces import Vector


@dataclass(frozen=True, eq=False, slots=True)
class Mapping:
    """Phi(1) of y'' = B u for the output of the law, once per period.

    Attributes:
        period: T [s].
        lead: (m,) c of z = y + c y' [s]; None: the output is y.
        output_order: Ly.
        input_order: Lu.
    """

    period: float
    lead: Vector | None
    output_order: int
    input_order: int

    def gain(self, response: Vector) -> Vector:
        """What one unit of du does to the outputs within a period, (m, m): T (c + T/2) B, of the position form T^2 B.

        With T^2 B the position form has the paper's (19), which lumps what a held command does in this period and the
        next; with Lu > 1 the two are separate, T^2/2 B each.
        """
        if self.lead is not None:
            return self.period * (self.lead + 0.5 * self.period)[:, None] * response
        return self.period * self.period * response / (2.0 if self.input_order > 1 else 1.0)

    def first(self, response: Vector) -> Vector:
        """Phi(1), (m, m (Ly+Lu)): past increments 2, -1 (of z: 1, 0), then the gain."""
        one, none = np.eye(response.shape[0]), np.zeros(response.shape)
        past = [one, none] if self.lead is not None else [2.0 * one, -one]
        past += [none] * (self.output_order - 2)
        inputs = [self.gain(response)] * (1 if self.lead is not None else min(2, self.input_order))
        inputs += [none] * (self.input_order - len(inputs))
        return np.hstack([*past[: self.output_order], *inputs])


@dataclass(frozen=True, eq=False, slots=True)
class Scales:
    """Units of the law: SI times ``output`` are its outputs, SI over ``input`` its inputs; (m,) each."""

    output: Vector
    input: Vector

    @classmethod
    def full_scale(cls, gain: Vector, limit: Vector) -> Scales:
        """The limit of each input, and what it does to its own output in a period; the diagonal of phi is 1."""
        return cls(1.0 / (np.abs(np.diag(gain)) * limit), limit)

    @classmethod
    def printed(cls, lengths: Vector, size: int) -> Scales:
        """Mm for ``lengths`` (m, bool), deg for the others; N and N m."""
        return cls(np.where(lengths, 1000.0, 180.0 / pi), np.ones(size))

    def scaled(self, first: Vector, output_order: int) -> Vector:
        """Phi in these units from Phi in SI."""
        m = self.output.size
        blocks = [first[:, m * i : m * (i + 1)] for i in range(first.shape[1] // m)]
        inside = [1.0 / self.output] * output_order + [self.input] * (len(blocks) - output_order)
        return np.hstack([self.output[:, None] * block * x for block, x in zip(blocks, inside, strict=True)])
