"""A law as two compiled functions and what they work on, for a run that calls no Python between its ticks."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from space_robot_control.kernel.answers import answer_example, ignore
from space_robot_description.kernel.context import Context
from space_robot_description.kernel.jit import bound
from space_robot_msgs_py.interfaces import Reference, RobotState, Vector

Function = Callable[..., Any]


@dataclass(frozen=True, eq=False, slots=True)
class Layout:
    """The blocks of a law's telemetry in one row.

    Attributes:
        labels: of the blocks.
        sizes: of the blocks.
    """

    labels: tuple[str, ...]
    sizes: tuple[int, ...]

    @classmethod
    def of(cls, blocks: Mapping[str, int]) -> Layout:
        """From label to size."""
        return cls(tuple(blocks), tuple(blocks.values()))

    @property
    def size(self) -> int:
        """Of the row."""
        return sum(self.sizes)

    def blocks(self, row: Vector) -> dict[str, Vector]:
        """The blocks of a row (size,)."""
        edges = np.cumsum((0, *self.sizes)).tolist()
        return {label: row[a:b] for label, (a, b) in zip(self.labels, pairwise(edges), strict=True)}


@dataclass(frozen=True, eq=False, slots=True)
class CompiledLaw:
    """A law for a compiled run; its memory is that of the law it was made of.

    Attributes:
        answer: see ``kernel.answers``.
        context: what both functions work on.
        layout: of the telemetry.
        note: see ``kernel.answers``.
        start: called with the first state before anything else.
    """

    answer: Function
    context: Context
    layout: Layout
    note: Function = ignore
    start: Callable[[RobotState], None] = lambda state: None


class Answering:
    """Calls ``answer`` from Python.

    Args:
        answer: compiled, see ``kernel.answers``.
        joints: of the robot.
        layout: of the telemetry.
    """

    def __init__(self, answer: Function, joints: int, layout: Layout) -> None:
        self._joints, self._size = joints, layout.size
        self._answer = answer
        self._code: Function | None = None

    def prepare(self) -> Function:
        """Load or compile what is called, which the first call does else, and return it."""
        if self._code is None:
            self._code = bound(self._answer, 0, *answer_example(self._joints, self._size))
        return self._code

    def __call__(
        self, context: Context, state: RobotState, reference: Reference, wheels: Vector
    ) -> tuple[int, Vector, Vector]:
        """Return status, command u (6+n,) and row of telemetry.

        Args:
            context: of the law.
            state: measured.
            reference: of the same stamp.
            wheels: (3,) momentum of the nominal wheels, body frame [N m s].
        """
        code = self._code or self.prepare()
        u, row = np.empty(6 + self._joints), np.empty(self._size)
        measured = state.q, state.v, state.effort, state.base_acceleration
        status = code(context.address, *measured, wheels, reference.q, reference.v, reference.a, u, row)
        return status, u, row
