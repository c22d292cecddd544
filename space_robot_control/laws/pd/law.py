"""PD on the channels and samples of the model-free law: the baseline beside it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from pydantic import Field, PositiveFloat

from space_robot_control.channels import Channels
from space_robot_control.laws.base import Blocks, Law, Review
from space_robot_control.laws.gain_range import GainRange, GainRanges
from space_robot_control.nominal_model import NominalModel
from space_robot_control.sampled_stability import stability_margin
from space_robot_control.sensing import FilterSpec, Sensing
from space_robot_control.tracking import ERROR_FIELDS, error_blocks, tracking_errors
from space_robot_description.fields import DYNAMIC
from space_robot_description.robot import Robot
from space_robot_description.spec import expand
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
        self.retune(self.gains)
        self._sensing = Sensing(self.channels, self.gains.filter, control_period)
        self._response: Vector | None = None

    def retune(self, gains: Gains) -> None:
        """Go on with another bandwidth or damping."""
        self._wn = expand(gains.bandwidth, self.channels.names, "controller.gains.bandwidth")

    def reset(self) -> None:
        """Forget filter and response."""
        super().reset()
        self._sensing.reset()
        self._response = None

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
        """Return u and the telemetry listed at the class."""
        errors, sensing = tracking_errors(state, reference), self._sensing
        sensing.update(state, reference, self.channels.errors(state, errors))
        if self._response is None:
            self._response = self.channels.response(self._model, state.q)
        acceleration = self._wn**2 * sensing.error + 2.0 * self.gains.damping * self._wn * sensing.rate
        u = self.channels.spread(np.array(np.linalg.solve(self._response, acceleration)))
        return u, {
            **error_blocks(errors),
            "output": sensing.error,
            "output_rate": sensing.rate,
            "gate_count": sensing.refused.sum(),
            "gains_inverse": np.diag(self._response),
        }
