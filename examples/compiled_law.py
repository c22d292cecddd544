"""A law of your own, compiled: springs on the joints, dampers on all that turns; one function for every way to run.

space-robot run liu2023/fig08 --set controller.law=examples/compiled_law.py:Springs --set controller.gains={}
"""

from typing import NamedTuple

import numpy as np

import space_robot as sr
from space_robot_control.kernel.answers import ANSWERED
from space_robot_control.laws.compiled import Answering, CompiledLaw, Layout
from space_robot_description.kernel.context import context_of, kind_of, loaded, stored
from space_robot_description.kernel.jit import kernel


class Memory(NamedTuple):
    """Gains k and d, and the last errors: numbers that stay, arrays of one or two dimensions that may change."""

    gains: sr.Vector
    errors: sr.Vector


KIND = kind_of(Memory(np.zeros(2), np.zeros(1)))


@kernel
def keep(values, room):
    """Give the memory an address: this line is the same for every law."""
    return stored(values, room)


@kernel
def answer(context, q, v, effort, acceleration, wheels, q_d, v_d, a_d, u, row):
    """Write the command u = k (q_d - q) - d v and the row of telemetry; returns a status."""
    law = loaded(context, KIND)
    for i in range(v.shape[0]):
        law.errors[i] = q_d[i + 1] - q[i + 1] if i >= 6 else 0.0
        u[i], row[i] = law.gains[0] * law.errors[i] - law.gains[1] * v[i] if i >= 3 else 0.0, law.errors[i]
    return ANSWERED


class Springs(sr.Law):
    """The law around it: the memory, and two ways to be called."""

    def __init__(self, robot: sr.Robot, control_period: float, gains: sr.Law.Gains | None = None) -> None:
        super().__init__(robot, control_period, gains)
        memory, layout = Memory(np.array([0.05, 0.2]), np.zeros(6 + self.n)), Layout.of({"error": 6 + self.n})
        self.form = CompiledLaw(answer, context_of(memory, keep), layout)
        self.call = Answering(answer, self.n, layout)

    def compiled(self) -> CompiledLaw:
        """For studies of many runs, which call no Python between the ticks of a run."""
        return self.form

    def compute(self, state: sr.RobotState, reference: sr.Reference) -> tuple[sr.Vector, sr.Blocks]:
        """For everything else."""
        _, u, row = self.call(self.form.context, state, reference, self.wheels.momentum)
        return u, self.form.layout.blocks(row)
