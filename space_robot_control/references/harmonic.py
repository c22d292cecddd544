"""Sums of waves about a configuration with a soft start: motion that excites what is to be identified."""

from __future__ import annotations

from collections.abc import Sequence
from math import radians, tau
from typing import cast

import numpy as np

from space_robot_control.references.profile import in_body, nanoseconds, quintic
from space_robot_control.references.rows import identity_of
from space_robot_control.references.spec import HarmonicSpec, Wave, Waves
from space_robot_control.references.targets import check_limits, configuration
from space_robot_description.robot import Robot
from space_robot_description.rotations import from_rpy, rpy_rates, to_rpy
from space_robot_description.spec import check_joint_names
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Reference, Vector
from space_robot_msgs_py.kernel.elementary import sincos
from space_robot_msgs_py.kernel.products import times


class Harmonic:
    """x(t) = center + r(t) sum_k A_k sin(omega_k t + phi_k) for each channel, r the quintic ramp from 0 to 1.

    The channels are x, y, z, roll, pitch, yaw, joints. The ramp makes position, velocity and acceleration continuous at
    the start: a bare sine starts with a step of velocity, a bare cosine with one of position.

    Args:
        center: (7+n,) configuration [m, -, rad].
        channel: (k,) index of each wave's channel.
        amplitude: (k,) [m or rad].
        omega: (k,) angular frequency [rad/s].
        phase: (k,) [rad].
        start: [ns].
        soft_start: duration of the ramp [ns], positive.

    Attributes:
        identity: see ``rows.rows_of``.

    Reference: Euler rates to body rates as in Liu, Teng, Jin, Aerospace 10, 679, 2023, sec. 2.
    """

    def __init__(
        self,
        center: Vector,
        channel: Sequence[int],
        amplitude: Sequence[float],
        omega: Sequence[float],
        phase: Sequence[float],
        start: int,
        soft_start: int,
    ) -> None:
        self._center = np.concatenate((center[:3], to_rpy(center[3:7]), center[7:]))
        self._omega, self._phase = np.array(omega, dtype=np.float64), np.array(phase, dtype=np.float64)
        self._mix = np.zeros((len(channel), self._center.size))
        self._mix[np.arange(len(channel)), list(channel)] = amplitude
        self._start, self._soft_start = start, soft_start
        self.identity = identity_of(center, self._mix, self._omega, self._phase, start, soft_start)

    def at(self, stamp: int) -> Reference:
        """Return the reference at a stamp [ns]."""
        x, dx, ddx = self._channels(max(0, stamp - self._start))
        omega, alpha = rpy_rates(x[3:6], dx[3:6], ddx[3:6])
        q = [*x[:3], *from_rpy(x[3:6]), *x[6:]]
        return in_body(stamp, q, [*dx[:3], *omega, *dx[6:]], [*ddx[:3], *alpha, *ddx[6:]])

    def _channels(self, elapsed: int) -> list[list[float]]:
        seconds = 1e-9 * self._soft_start
        ramp, rise, bend = quintic(elapsed / self._soft_start)
        rise, bend = rise / seconds, bend / (seconds * seconds)
        angle = self._omega * (1e-9 * elapsed) + self._phase
        wave, cosine = np.array([sincos(one) for one in angle.tolist()]).reshape(-1, 2).T
        dwave = self._omega * cosine
        ddwave = -self._omega * self._omega * wave
        # Rows: the waves and their derivatives; the ramp comes in by the product rule for (r f), (r f)', (r f)''.
        product_rule = np.array(((ramp, 0.0, 0.0), (rise, ramp, 0.0), (bend, 2.0 * rise, ramp)))
        channels = times(times(product_rule, np.array((wave, dwave, ddwave))), self._mix)
        channels[0] += self._center
        return cast("list[list[float]]", channels.tolist())


def harmonic(spec: HarmonicSpec, robot: Robot, initial_q: Vector, key: str) -> Harmonic:
    """Build from a spec.

    Raises:
        SpecError: the joints do not fit the robot, or can leave their limits.
    """
    center = configuration(spec.center, robot, initial_q, f"{key}.center")
    base = (spec.x, spec.y, spec.z, spec.roll, spec.pitch, spec.yaw)
    channels = [*map(_listed, base), *_joint_waves(spec, robot, f"{key}.joints")]
    waves = [(index, wave) for index, listed in enumerate(channels) for wave in listed]
    for index, wave in waves:
        if index < 3 and wave.amplitude is None:
            raise SpecError("an amplitude in degrees", key=f"{key}.{'xyz'[index]}", accepted="amplitude [m]")
    swing = np.array([sum(abs(_amplitude(wave)) for wave in listed) for listed in channels[6:]])
    moving = swing > 0.0
    lowest = np.where(moving, center[7:] - swing, robot.joint_lower)
    highest = np.where(moving, center[7:] + swing, robot.joint_upper)
    check_limits(lowest, highest, robot, f"{key}.joints")
    return Harmonic(
        center,
        channel=[index for index, _ in waves],
        amplitude=[_amplitude(wave) for _, wave in waves],
        omega=[tau * wave.frequency for _, wave in waves],
        phase=[radians(wave.phase_deg) for _, wave in waves],
        start=nanoseconds(spec.start, f"{key}.start"),
        soft_start=nanoseconds(spec.soft_start, f"{key}.soft_start"),
    )


def _joint_waves(spec: HarmonicSpec, robot: Robot, key: str) -> list[tuple[Wave, ...]]:
    joints, names = spec.joints, robot.joint_names
    if isinstance(joints, dict):
        check_joint_names(list(joints), names, key)
        return [_listed(joints.get(name, ())) for name in names]
    if len(joints) not in (0, len(names)):
        accepted = f"{len(names)} entries, in the order {', '.join(names)}"
        raise SpecError("wrong number of entries", key=key, value=len(joints), accepted=accepted)
    return [_listed(waves) for waves in joints or ((),) * len(names)]


def _listed(waves: Waves) -> tuple[Wave, ...]:
    return (waves,) if isinstance(waves, Wave) else waves


def _amplitude(wave: Wave) -> float:
    return radians(wave.amplitude_deg) if wave.amplitude_deg is not None else float(wave.amplitude or 0.0)
