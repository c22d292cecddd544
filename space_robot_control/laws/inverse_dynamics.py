"""What laws have in common that ask for an acceleration and command what it takes in the nominal model."""

from __future__ import annotations

from space_robot_control.laws.base import Blocks, Law
from space_robot_control.laws.compiled import Answering, CompiledLaw
from space_robot_control.nominal_model import not_finite
from space_robot_msgs_py.interfaces import Reference, RobotState, Vector


class InverseDynamics(Law):
    """u = M0(q) a + c0(q, v) + omega x h by one kernel, which has no memory from one period to the next.

    Subclasses make ``_answer`` once, ``_form`` in ``retune``, and ``_acceleration``, in which the kernel leaves a.
    """

    _answer: Answering
    _form: CompiledLaw
    _acceleration: Vector

    def prepare(self) -> None:
        """Compile the answer."""
        self._answer.prepare()

    def compiled(self) -> CompiledLaw:
        """The law for compiled runs."""
        return self._form

    def compute(self, state: RobotState, reference: Reference) -> tuple[Vector, Blocks]:
        """Return u and the telemetry listed at the class.

        Raises:
            ControlError: the inverse dynamics of the nominal model is not finite.
        """
        status, u, row = self._answer(self._form.context, state, reference, self.wheels.momentum)
        if status:
            raise not_finite(self._acceleration)
        return u, self._form.layout.blocks(row)
