"""The base from any state to rest in a pose, at a bounded speed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import hypot

import numpy as np

from space_robot_control.references.spline import piece_at, quintic_piece
from space_robot_description.rotations import Quaternion, cross, exp, log, product, relative
from space_robot_msgs_py.interfaces import NANOSECONDS, Vector
from space_robot_msgs_py.kernel.elementary import sincos

# The largest speed of a quintic from rest to rest, in units of its mean speed.
PEAK = 1.875
# A motion that is under way is given more time until it keeps the speed; samples to see whether it does.
LONGER, TRIES, SAMPLES, TOLERANCE = 1.2, 40, 33, 1.01


@dataclass(frozen=True, eq=False, slots=True)
class BaseMotion:
    """Pose, rates and accelerations of the base at one stamp.

    Attributes:
        position: (3,) inertial [m].
        quaternion: body to inertial.
        velocity: (3,) inertial [m/s].
        rate: (3,) body axes [rad/s].
        acceleration: (3,) inertial [m/s2].
        rate_change: (3,) derivative of the components of ``rate`` [rad/s2].
    """

    position: Sequence[float]
    quaternion: Sequence[float]
    velocity: Sequence[float] = (0.0, 0.0, 0.0)
    rate: Sequence[float] = (0.0, 0.0, 0.0)
    acceleration: Sequence[float] = (0.0, 0.0, 0.0)
    rate_change: Sequence[float] = (0.0, 0.0, 0.0)


class BasePath:
    """Quintic in the position and in the rotation vector theta from the first attitude, R = R0 exp(theta).

    At theta = 0 the body rate is theta' and its derivative theta'', so that the motion goes on as it was.

    Args:
        first: where it starts.
        position: (3,) where it ends [m].
        quaternion: attitude in which it ends, reached the short way.
        start: [ns].
        duration: [ns]; 0: it is there.

    Attributes:
        end: when it is at rest [ns].
    """

    def __init__(
        self, first: BaseMotion, position: Sequence[float], quaternion: Sequence[float], start: int, duration: int
    ) -> None:
        turn = log(relative(first.quaternion, quaternion))
        self._first, self._start, self._duration = first.quaternion, start, duration
        self._last = BaseMotion(list(position), product(first.quaternion, exp(turn)))
        self.end, h = start + duration, duration / NANOSECONDS
        zero = np.zeros(6)
        x = np.array(((*first.position, *zero[:3]), (*position, *turn)))
        v = np.array(((*first.velocity, *first.rate), zero))
        a = np.array(((*first.acceleration, *first.rate_change), zero))
        self._piece: Vector = quintic_piece(x, h * v, h * h * a)

    def at(self, stamp: int) -> BaseMotion:
        """Return the motion at a stamp not before the start [ns]."""
        if stamp >= self.end:
            return self._last
        t = (stamp - self._start) / self._duration
        x, dx, ddx = piece_at(self._piece, t, self._duration / NANOSECONDS)
        rate, change = body_rates(x[3:], dx[3:], ddx[3:])
        return BaseMotion(x[:3], product(self._first, exp(x[3:])), dx[:3], rate.tolist(), ddx[:3], change.tolist())

    def keeps(self, speed: float, rate: float) -> bool:
        """True where it is never faster than this [m/s, rad/s]."""
        stamps = np.linspace(self._start, self.end, SAMPLES).round().astype(int).tolist()
        motions = [self.at(stamp) for stamp in stamps]
        return max(hypot(*one.velocity) for one in motions) <= TOLERANCE * speed and (
            max(hypot(*one.rate) for one in motions) <= TOLERANCE * rate
        )


def path_to(
    first: BaseMotion, position: Sequence[float], quaternion: Quaternion, start: int, speed: float, rate: float
) -> BasePath:
    """Return a path that keeps a speed [m/s] and a rate [rad/s], but for what it has of them at its start."""
    far = hypot(*(b - a for a, b in zip(first.position, position, strict=True)))
    turn = hypot(*log(relative(first.quaternion, quaternion)))
    # At least as long as it takes to come to rest.
    still = 2.0 * max(hypot(*first.velocity) / speed, hypot(*first.rate) / rate)
    seconds = max(PEAK * far / speed, PEAK * turn / rate, still)
    path = BasePath(first, position, quaternion, start, round(seconds * NANOSECONDS))
    for _ in range(TRIES):
        if path.keeps(speed, rate):
            break
        seconds *= LONGER
        path = BasePath(first, position, quaternion, start, round(seconds * NANOSECONDS))
    return path


def body_rates(theta: Sequence[float], d: Sequence[float], dd: Sequence[float]) -> tuple[Vector, Vector]:
    """Return body rate and its derivative of R0 exp(theta): omega = J theta', with the right Jacobian J of SO(3).

    J = 1 - A [theta] + B [theta]^2, A = (1 - cos phi) / phi^2, B = (phi - sin phi) / phi^3, phi = |theta|.

    Args:
        theta: (3,) [rad].
        d: (3,) its derivative [rad/s].
        dd: (3,) its second derivative [rad/s2].

    Reference: Chirikjian, "Stochastic Models, Information Theory, and Lie Groups", vol. 2, 2012, sec. 10.6.
    """
    a, b, da, db = _coefficients(hypot(*theta))
    along = sum(x * y for x, y in zip(theta, d, strict=True))
    once, twice = np.array(cross(theta, d)), np.array(cross(theta, cross(theta, d)))
    rate = np.array(d) - a * once + b * twice
    change = np.array(dd) - a * np.array(cross(theta, dd)) + b * np.array(cross(theta, cross(theta, dd)))
    change += along * (db * twice - da * once) + b * np.array(cross(d, cross(theta, d)))
    return rate, change


def _coefficients(phi: float) -> tuple[float, float, float, float]:
    """A, B, and their derivatives by phi over phi."""
    if phi < 1e-2:
        p = phi * phi
        return 0.5 - p / 24.0, 1.0 / 6.0 - p / 120.0, p / 180.0 - 1.0 / 12.0, p / 1260.0 - 1.0 / 60.0
    (sine, cosine), square = sincos(phi), phi * phi
    a, b = (1.0 - cosine) / square, (phi - sine) / (square * phi)
    return a, b, (sine / phi - 2.0 * a) / square, (a - 3.0 * b) / square
