"""Sampled errors for a law without a model: filtered, and split into the reference's motion and the robot's own."""

from __future__ import annotations

import numpy as np
from pydantic import Field, NonNegativeInt, PositiveFloat

from space_robot_control.channels import BASE, ChannelErrors, Channels
from space_robot_control.gated_filter import GatedFilter
from space_robot_control.tracking import tracking_errors
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
    """Errors of the channels, their rates and the robot's own motion, tick by tick.

    Without a filter the errors and rates are those of the measured state. With one, the rate comes from the positions
    and the measured velocity is not used. The robot's own motion is what is left of the change of the error when the
    change of the reference is taken out, so that a moving or jumping reference does not disturb an estimator.

    Args:
        channels: of the law.
        spec: the filter, or None.
        period: control period [s].

    Attributes:
        error: (m,) error [m, rad].
        rate: (m,) its rate [m/s, rad/s].
        sample: (m,) the error before the filter, wrong samples replaced.
        moved: (m,) own motion since the last tick, from ``error`` [m, rad].
        moved_sample: (m,) the same from ``sample``.
        sped: (m,) own change of velocity since the last tick [m/s, rad/s].
        missing: (m,) True where the sample was refused.
        refused: (m,) samples refused so far.
    """

    def __init__(self, channels: Channels, spec: FilterSpec | None, period: float) -> None:
        self._channels, self._period = channels, period
        self._filter: GatedFilter | None = None
        if spec is not None:
            lengths = [name in BASE[:3] for name in channels.names]
            gate = np.where(lengths, spec.gate_length, np.radians(spec.gate_angle_deg))
            self._filter = GatedFilter(period, spec.bandwidth, gate, spec.patience)
        self.reset()

    def reset(self) -> None:
        """Forget the past."""
        zero = np.zeros(self._channels.size)
        self.error = self.rate = self.sample = self.moved = self.moved_sample = self.sped = self.refused = zero
        self.missing = zero > 0.0
        self._last: tuple[RobotState, Reference, ChannelErrors] | None = None
        if self._filter is not None:
            self._filter.reset()

    def update(self, state: RobotState, reference: Reference, now: ChannelErrors) -> None:
        """Take the errors of one tick."""
        desired_move, desired_change, jump = self._reference_change(reference, now)
        error, rate, sample = self.error, self.rate, self.sample
        if self._filter is None:
            self.error, self.rate, self.sample = now.error, now.rate, now.error
        else:
            self._filter.update(now.error, jump)
            self.error, self.rate, self.sample = self._filter.value, self._filter.rate, self._filter.sample
            self.missing, self.refused = self._filter.missing, self._filter.refused
        if self._last is not None:
            self.moved = desired_move - (self.error - error)
            self.moved_sample = desired_move - (self.sample - sample)
            self.sped = desired_change - (self.rate - rate)
        self._last = state, reference, now

    def _reference_change(self, reference: Reference, now: ChannelErrors) -> tuple[Vector, Vector, Vector]:
        """Motion and change of velocity of the reference since the last tick, and what of the motion was a jump."""
        if self._last is None:
            zero = np.zeros(self._channels.size)
            return zero, zero, zero
        state, before, errors = self._last
        if before.q.tobytes() == reference.q.tobytes():
            moved = np.zeros(self._channels.size)
        else:
            # The last state against the new reference: exact for any chart of the attitude, also for a jump.
            moved = self._channels.errors(state, tracking_errors(state, reference)).error - errors.error
        return moved, now.velocity - errors.velocity, moved - 0.5 * self._period * (now.velocity + errors.velocity)
