"""What the cameras of the testbed see: late, noisy, now and then wrong, and positions only."""

from __future__ import annotations

from math import radians

import numpy as np

from space_robot_msgs_py.interfaces import NANOSECONDS, RobotState, Vector
from space_robot_msgs_py.kernel.elementary import atan2, sincos
from space_robot_sim.grasp.spec import CameraSpec


class Camera:
    """Measures x, y and yaw of the base and the joints of the grasp, once per control period.

    The velocities it gives are differences of its own readings over a period, and there is no accelerometer: the
    acceleration reads zero. Noise, outliers and dropouts draw from generators of their own.

    Args:
        spec: of all channels.
        lengths: (n,) True where a joint is a length.
        period: control period [ns].
        seed: of all generators.
    """

    def __init__(self, spec: CameraSpec, lengths: Vector, period: int, seed: int) -> None:
        self._spec, self._seconds, self._seed = spec, period / NANOSECONDS, seed
        is_length = np.concatenate([[True, True, False], lengths])
        self._noise = np.where(is_length, spec.position_noise, radians(spec.angle_noise_deg))
        self._wrong = np.where(is_length, spec.outlier_length, radians(spec.outlier_angle_deg))
        self.reset()

    def reset(self) -> None:
        """Restart every generator and forget the last reading."""
        children = np.random.SeedSequence(self._seed).spawn(3)
        self._noises, self._outliers, self._dropouts = (np.random.default_rng(child) for child in children)
        self._last: Vector | None = None

    def measure(self, stamp: int, q: Vector) -> RobotState:
        """Return the reading at a stamp [ns] of the configuration q (7+n,) when the shutter was open."""
        truth = np.concatenate([q[:2], [2.0 * atan2(float(q[5]), float(q[6]))], q[7:]])
        reading = truth + self._noise * self._noises.standard_normal(truth.size)
        # Drawn every time, so that the share of one distortion never moves the draws of another.
        struck, error = self._outliers.random(), self._outliers.uniform(-1.0, 1.0, truth.size)
        if struck < self._spec.outlier_share:
            reading = reading + self._wrong * error
        if self._dropouts.random() < self._spec.dropout_share and self._last is not None:
            reading = self._last
        before = reading if self._last is None else self._last
        self._last = reading
        return self._state(stamp, reading, (reading - before) / self._seconds)

    def _state(self, stamp: int, reading: Vector, rate: Vector) -> RobotState:
        x, y, yaw = reading[:3].tolist()
        n, (s, c), half = reading.size - 3, sincos(yaw), sincos(0.5 * yaw)
        forward, sideways = c * rate[0] + s * rate[1], -s * rate[0] + c * rate[1]
        q = [x, y, 0.0, 0.0, 0.0, *half, *reading[3:].tolist()]
        v = [forward, sideways, 0.0, 0.0, 0.0, rate[2], *rate[3:].tolist()]
        return RobotState(stamp, np.array(q), np.array(v), np.zeros(n), np.zeros(3))
