"""Sampled errors for a law without a model: filtered, and split into the reference's motion and the robot's own."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from pydantic import Field, NonNegativeInt, PositiveFloat

from space_robot_control.channels import BASE, Channels
from space_robot_control.gated_filter import filter_rule
from space_robot_control.kernel.sensing import SensingRule, restart_sensing, sense, sensing_memory
from space_robot_control.tracking import TrackingErrors
from space_robot_description.kernel.jit import bound
from space_robot_description.spec import Strict
from space_robot_msgs_py.interfaces import Reference, RobotState, Vector


class FilterSpec(Strict):
    """A filter for robots whose sensors give positions only, and now and then a wrong one."""

    bandwidth: PositiveFloat = Field(default=3.0, description="of the filter [rad/s]")
    gate_angle_deg: PositiveFloat = Field(default=0.5, description="largest credible jump of an angle [deg]")
    gate_length: PositiveFloat = Field(default=0.01, description="largest credible jump of a position [m]")
    patience: NonNegativeInt = Field(
        default=20, description="refusals in a row after which the next sample is accepted [-]"
    )


class Sensing:
    """Errors of the channels, their rates and the robot's own motion, tick by tick; desired minus actual.

    The error is R^T (p_d - p) for the position [m], 2 epsilon of the error quaternion for the attitude [rad], q_d - q
    for joints [rad or m]; its rate is the error of the velocity, in the actual body frame.

    Without a filter the errors and rates are those of the measured state. With one, the rate comes from the positions
    and the measured velocity is not used. The robot's own motion is what is left of the change of the error when the
    change of the reference is taken out, so that a moving or jumping reference does not disturb an estimator.

    Args:
        channels: of the law.
        spec: the filter, or None.
        period: control period [s].

    Attributes:
        rule: the numbers, for kernels.
        memory: what is sensed and remembered, for kernels: ``error`` (m,) [m, rad], ``rate`` (m,) [m/s, rad/s];
            ``sample``, the error before the filter, wrong samples replaced; ``moved`` and ``moved_sample``, the own
            motion since the last tick from the two; ``sped``, own change of velocity since then.
    """

    def __init__(self, channels: Channels, spec: FilterSpec | None, period: float) -> None:
        known = spec or FilterSpec()
        lengths = [name in BASE[:3] for name in channels.names]
        gate = np.where(lengths, known.gate_length, np.radians(known.gate_angle_deg))
        numbers = filter_rule(period, known.bandwidth, gate, known.patience)
        self.rule = SensingRule(channels.index, int(spec is not None), numbers)
        self.memory = sensing_memory(channels.joints, channels.size)
        self._sense: Callable[..., None] | None = None

    def reset(self) -> None:
        """Forget the past."""
        restart_sensing(self.memory)

    def update(self, state: RobotState, reference: Reference) -> TrackingErrors:
        """Take the errors of one tick; returns them as a whole.

        Args:
            state: measured.
            reference: of the same stamp.
        """
        if self._sense is None:
            q, v = np.zeros(7 + state.joints.size), np.zeros(6 + state.joints.size)
            self._sense = bound(sense, self.rule, self.memory, q, v, q, v, v)
        self._sense(self.rule, self.memory, state.q, state.v, reference.q, reference.v, reference.a)
        return TrackingErrors(*(part.copy() for part in self.memory.now))

    @property
    def refused(self) -> Vector:
        """(m,) samples refused so far; 0 without a filter."""
        return self.memory.filter.refused
