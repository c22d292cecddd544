"""PD on the channels and samples of the model-free law: the baseline beside it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from pydantic import Field, PositiveFloat

from space_robot_control.channels import Channels
from space_robot_control.laws.base import Blocks, Law, Review
from space_robot_control.laws.compiled import Answering, CompiledLaw, Layout
from space_robot_control.laws.gain_range import GainRange, GainRanges
from space_robot_control.laws.pd.kernel.answer import PdContext, answer, keep, pd_numbers
from space_robot_control.nominal_model import NominalModel
from space_robot_control.sampled_stability import stability_margin
from space_robot_control.sensing import FilterSpec, Sensing
from space_robot_control.tracking import ERROR_FIELDS
from space_robot_description.fields import DYNAMIC
from space_robot_description.kernel.context import context_of
from space_robot_description.kernel.dense import factor
from space_robot_description.robot import Robot
from space_robot_description.spec import expand
from space_robot_msgs_py.errors import ControlError
from space_robot_msgs_py.interfaces import Reference, RobotState, Vector


class ProportionalDerivative(Law):
    """u = B^-1 (wn^2 e + 2 zeta wn e'), B the nominal response of the channels at the first state, constant.

    e and e' are the outputs of ``Channels`` and ``Sensing``: attitude as 2 epsilon of the error quaternion. There is no
    feed-forward and no model of the motion: B is the same prior knowledge as Phi(1) of the model-free law.

    Args:
        robot: the NOMINAL robot.
        control_period: [s].
        gains: bandwidth, damping, outputs, held, filter.

    Raises:
        SpecError: a channel the robot does not have.

    The equations on one screen: ``reference.py``.

    Deviations from the paper: Song et al. (2023) compare with nothing; this baseline is an addition.
    """

    class Gains(Law.Gains):
        """Gains of the PD law."""

        bandwidth: PositiveFloat | dict[str, PositiveFloat] = Field(
            default=0.5,
            description="wn, one number or a mapping by channel [rad/s]",
            json_schema_extra=DYNAMIC,
        )
        damping: PositiveFloat = Field(default=1.0, description="zeta of every channel [-]", json_schema_extra=DYNAMIC)
        outputs: tuple[str, ...] = Field(
            default=(), description="channels: x, y, z, roll, pitch, yaw, joint names; default all"
        )
        held: tuple[str, ...] = Field(default=(), description="joints taken as rigid, where the robot file has them")
        filter: FilterSpec | None = Field(default=None, description="rates from positions, and a gate; default: none")

    name = "pd"
    gain_ranges: ClassVar[GainRanges] = {
        "bandwidth": GainRange(0.02, 2.0),
        "damping": GainRange(0.4, 2.0, "linear"),
    }
    telemetry_fields = ERROR_FIELDS | {
        "output": "e of the channels [m, rad]",
        "output_rate": "e' of the channels [m/s, rad/s]",
        "gate_count": "samples refused by the gate so far [-]",
        "gains_inverse": "diagonal of B [1/kg, 1/(kg m2)]",
    }
    gains: Gains

    def __init__(self, robot: Robot, control_period: float, gains: Gains | None = None) -> None:
        super().__init__(robot, control_period, gains)
        self.channels = Channels(robot, self.gains.outputs, self.gains.held)
        self._model = NominalModel(robot)
        self._sensing = Sensing(self.channels, self.gains.filter, control_period)
        self._numbers, self.layout = pd_numbers(self.channels.size), _layout(self.n, self.channels.size)
        context = PdContext(self._sensing.rule, self._sensing.memory, self._numbers)
        self._context, self._answer = context_of(context, keep), Answering(answer, self.n, self.layout)
        self._begun = False
        self.retune(self.gains)

    def retune(self, gains: Gains) -> None:
        """Go on with another bandwidth or damping."""
        self._wn = expand(gains.bandwidth, self.channels.names, "controller.gains.bandwidth")
        self._numbers.kp[:], self._numbers.kd[:] = self._wn * self._wn, 2.0 * gains.damping * self._wn

    def reset(self) -> None:
        """Forget filter and response."""
        super().reset()
        self._sensing.reset()
        self._begun = False

    def prepare(self) -> None:
        """Compile the answer."""
        self._answer.prepare()

    def compiled(self) -> CompiledLaw:
        """The law for compiled runs."""
        return CompiledLaw(answer, self._context, self.layout, start=self._begin)

    def review(self, path: Sequence[Reference]) -> Review:
        """Find by which factor each channel could be faster; warn where the sampled loop is unstable."""
        facts, warnings = [], []
        for name, wn in zip(self.channels.names, self._wn.tolist(), strict=True):
            margin = stability_margin(self.control_period, wn, self.gains.damping)
            facts.append(f"pd {name}: stable when sampled up to {margin:.3g} times the bandwidth")
            if margin <= 1.0:
                warnings.append(f"pd {name}: unstable when sampled every {self.control_period:g} s")
        return Review(tuple(facts), tuple(warnings))

    def compute(self, state: RobotState, reference: Reference) -> tuple[Vector, Blocks]:
        """Return u and the telemetry listed at the class.

        Raises:
            ControlError: B has no inverse.
        """
        if not self._begun:
            self._begin(state)
        _, u, row = self._answer(self._context, state, reference, self.wheels.momentum)
        return u, self.layout.blocks(row)

    def _begin(self, state: RobotState) -> None:
        """B is that of the first state."""
        numbers, response = self._numbers, self.channels.response(self._model, state.q)
        numbers.factors[:], numbers.response[:] = response, np.diag(response)
        if not factor(numbers.factors, numbers.pivots):
            raise ControlError("has no inverse", key="B", value=response.tolist())
        self._begun = True


def _layout(n: int, m: int) -> Layout:
    errors = {"position_error": 3, "attitude_error": 3, "joint_error": n, "twist_error": 6, "joint_rate_error": n}
    return Layout.of({**errors, "output": m, "output_rate": m, "gate_count": 1, "gains_inverse": m})
