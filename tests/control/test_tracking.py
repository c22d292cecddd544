"""Tracking errors and the feed-forward: what their derivation claims, seen by finite differences."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from space_robot_control.tracking import TrackingErrors, tracking_errors
from space_robot_description import rotations as rot
from space_robot_msgs_py.interfaces import Reference, RobotState, Vector
from tests.support.robots import arm_model, random_state

N = 3
MODEL = arm_model(N)


class Path:
    """A smooth motion q(t) = q0 exp(t v + t^2 a / 2), with exact v and a in the body frame at t = 0."""

    def __init__(self, rng: np.random.Generator) -> None:
        self.q, self.v = random_state(rng, N)
        self.a = rng.normal(size=6 + N)

    def at(self, t: float) -> tuple[Vector, Vector]:
        """Configuration, and velocity by the derivative of the exponential, exact to first order in t."""
        q = pin.integrate(MODEL, self.q, self.v * t + self.a * t * t / 2)
        return q, self.v + self.a * t


def errors_at(actual: Path, desired: Path, t: float) -> TrackingErrors:
    """Errors at a time near 0; only at t = 0 is the acceleration exact, elsewhere it is not used."""
    (q, v), (q_d, v_d) = actual.at(t), desired.at(t)
    state = RobotState(0, q, v, np.zeros(N), np.zeros(3))
    return tracking_errors(state, Reference(0, q_d, v_d, desired.a))


def inertial(actual: Path, t: float, r: Vector) -> Vector:
    """A body vector of the actual body in the inertial frame."""
    return np.array(rot.rotate(actual.at(t)[0][3:7], r))


@pytest.mark.parametrize("seed", range(20))
def test_velocity_error_is_the_derivative_of_the_configuration_error(seed: int) -> None:
    """The inertial position error and the joint error change at the velocity error; so does the relative attitude."""
    rng = np.random.default_rng(seed)
    actual, desired, h = Path(rng), Path(rng), 1e-5
    before, now, after = (errors_at(actual, desired, t) for t in (-h, 0.0, h))
    position = (inertial(actual, h, after.position) - inertial(actual, -h, before.position)) / (2 * h)
    np.testing.assert_allclose(position, inertial(actual, 0.0, now.twist[:3]), atol=1e-8)
    np.testing.assert_allclose((after.joints - before.joints) / (2 * h), now.joint_rates, atol=1e-8)
    # R_e' = S(e_w) R_e: the change of R_e, seen from the left.
    turned = rot.product(after.quaternion, rot.conjugate(before.quaternion))
    np.testing.assert_allclose(np.array(rot.log(turned)) / (2 * h), now.twist[3:], atol=1e-8)


@pytest.mark.parametrize("seed", range(20))
def test_feedforward_keeps_the_velocity_error(seed: int) -> None:
    """Under the feed-forward the inertial velocity error and the body and joint rate errors are stationary."""
    rng = np.random.default_rng(100 + seed)
    actual, desired, h = Path(rng), Path(rng), 1e-5
    actual.a = errors_at(actual, desired, 0.0).feedforward
    before, after = (errors_at(actual, desired, t) for t in (-h, h))
    linear = inertial(actual, h, after.twist[:3]) - inertial(actual, -h, before.twist[:3])
    np.testing.assert_allclose(linear / (2 * h), 0.0, atol=1e-8)
    np.testing.assert_allclose((after.twist[3:] - before.twist[3:]) / (2 * h), 0.0, atol=1e-8)
    np.testing.assert_allclose((after.joint_rates - before.joint_rates) / (2 * h), 0.0, atol=1e-8)


@pytest.mark.parametrize("seed", range(5))
def test_without_errors_the_feed_forward_is_the_reference_acceleration(seed: int) -> None:
    """On the reference all errors vanish and the feed-forward is the reference's own acceleration."""
    path = Path(np.random.default_rng(seed))
    errors = errors_at(path, path, 0.0)
    np.testing.assert_allclose(errors.configuration, 0.0, atol=1e-15)
    np.testing.assert_allclose(errors.velocity, 0.0, atol=1e-14)
    np.testing.assert_allclose(errors.feedforward, path.a, atol=1e-13)


@pytest.mark.parametrize("seed", range(5))
def test_errors_do_not_depend_on_the_inertial_frame(seed: int) -> None:
    """Moving actual and desired body by one rigid displacement changes no error: laws need no absolute attitude."""
    rng = np.random.default_rng(seed)
    actual, desired = Path(rng), Path(rng)
    before = errors_at(actual, desired, 0.0)
    turn, shift = rot.exp(rng.normal(size=3)), rng.normal(size=3)
    for path in (actual, desired):
        path.q[:3] = np.array(rot.rotate(turn, path.q[:3])) + shift
        path.q[3:7] = rot.product(turn, path.q[3:7])
    after = errors_at(actual, desired, 0.0)
    for name in ("configuration", "velocity", "feedforward", "quaternion"):
        np.testing.assert_allclose(getattr(after, name), getattr(before, name), atol=1e-12)


def test_attitude_error_goes_the_short_way() -> None:
    """A quaternion and its negative are one attitude: 350 degrees ahead is 10 degrees behind."""
    q = np.zeros(7 + N)
    q[6] = 1.0
    state = RobotState(0, q, np.zeros(6 + N), np.zeros(N), np.zeros(3))
    desired = q.copy()
    desired[3:7] = rot.exp((0.0, 0.0, np.radians(350.0)))
    zero = np.zeros(6 + N)
    errors = tracking_errors(state, Reference(0, desired, zero, zero))
    np.testing.assert_allclose(errors.attitude, [0.0, 0.0, -np.radians(10.0)], atol=1e-14)
    assert errors.quaternion[3] > 0.0
