"""Rotations: algebra, the ends of the domain, and an independent implementation."""

from __future__ import annotations

from itertools import pairwise
from math import pi

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from space_robot_description import rotations as rot
from space_robot_description.kernel import quaternion as text
from space_robot_description.kernel.jit import kernel
from space_robot_description.kernel.spatial import mul
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Vector

RNG = np.random.default_rng(20240607)
QUATERNIONS = [q / np.linalg.norm(q) for q in RNG.normal(size=(50, 4))]


def kernel_text(a: Vector, b: Vector, r: Vector, out: Vector) -> None:
    """What the kernels' functions make of two quaternions and a vector, one after the other."""
    p, q, v = (a[0], a[1], a[2], a[3]), (b[0], b[1], b[2], b[3]), (r[0], r[1], r[2])
    out[0], out[1], out[2], out[3] = text.relative(p, q)
    out[4], out[5], out[6] = text.rotate(p, v)
    out[7], out[8], out[9] = text.rotate_inverse(p, v)
    out[10], out[11], out[12] = mul(text.matrix(p), v)
    out[13], out[14], out[15], out[16] = text.quaternion_rate(p, v)
    out[17], out[18], out[19] = text.log(text.relative(p, q))


compiled = kernel(kernel_text)


def test_kernels_have_the_same_algebra() -> None:
    """Every function of the kernels' text gives the bits of its namesake; the logarithm the same to the last digits."""
    out = np.empty(20)
    for a, b in pairwise(QUATERNIONS):
        r = a[:3] - b[1:]
        compiled(a, b, r, out)
        turned = rot.rotate_by_matrix(a, r)
        same = (rot.relative(a, b), rot.rotate(a, r), rot.rotate_inverse(a, r), turned, rot.quaternion_rate(a, r))
        assert out[:17].tolist() == [number for numbers in same for number in numbers]
        np.testing.assert_allclose(out[17:], rot.log(rot.relative(a, b)), rtol=1e-15)
        np.testing.assert_allclose(turned, rot.rotate(a, r), atol=1e-15)


@pytest.mark.parametrize("index", range(0, 50, 7))
def test_rotation_functions_agree_with_scipy(index: int) -> None:
    """Product, inverse, rotation, matrix, logarithm and roll-pitch-yaw are those of an independent implementation."""
    a, b, r = QUATERNIONS[index], QUATERNIONS[index - 1], RNG.normal(size=3)
    first, second = Rotation.from_quat(a), Rotation.from_quat(b)
    np.testing.assert_allclose(rot.matrix(rot.product(a, b)), (first * second).as_matrix(), atol=1e-14)
    np.testing.assert_allclose(rot.matrix(rot.conjugate(a)), first.inv().as_matrix(), atol=1e-14)
    np.testing.assert_allclose(rot.matrix(rot.relative(a, b)), (first.inv() * second).as_matrix(), atol=1e-14)
    np.testing.assert_allclose(rot.rotate(a, r), first.apply(r), atol=1e-14)
    np.testing.assert_allclose(rot.rotate_inverse(a, r), first.inv().apply(r), atol=1e-14)
    np.testing.assert_allclose(rot.log(a), first.as_rotvec(), atol=1e-13)
    np.testing.assert_allclose(rot.to_rpy(a), first.as_euler("xyz"), atol=1e-12)
    np.testing.assert_allclose(rot.matrix(rot.from_rpy(r)), Rotation.from_euler("xyz", r).as_matrix(), atol=1e-14)
    np.testing.assert_allclose(rot.cross(a[:3], r), np.cross(a[:3], r), atol=1e-15)


@pytest.mark.parametrize("angle", [0.0, 1e-300, 1e-160, 1e-12, 1e-6, 1.0, pi - 1e-9, pi])
def test_exp_and_log_are_inverse_to_full_relative_accuracy(angle: float) -> None:
    """log(exp(r)) = r from the smallest angles up to pi."""
    axis = np.array([2.0, -3.0, 6.0]) / 7.0
    np.testing.assert_allclose(rot.log(rot.exp(angle * axis)), angle * axis, rtol=4e-16 * 4, atol=0.0)


def test_log_takes_the_short_way() -> None:
    """A rotation by more than pi is the opposite rotation by less, and q and -q are one rotation."""
    axis = np.array([0.0, 0.6, 0.8])
    np.testing.assert_allclose(rot.log(rot.exp(1.5 * pi * axis)), -0.5 * pi * axis, atol=1e-15)
    for q in QUATERNIONS:
        assert rot.log(q) == rot.log(-q)
        assert np.linalg.norm(rot.log(q)) <= pi


def test_relative_has_no_negative_scalar_and_calls_zero_positive() -> None:
    """The relative quaternion has w >= 0; where w is zero its sign is left alone (sgn(0) = +1)."""
    for a in QUATERNIONS:
        for b in QUATERNIONS[:10]:
            assert rot.relative(a, b)[3] >= 0.0
    assert rot.relative((0.0, 0.0, 0.0, 1.0), (1.0, 0.0, 0.0, 0.0)) == (1.0, 0.0, 0.0, 0.0)
    assert rot.relative((0.0, 0.0, 0.0, 1.0), (-1.0, 0.0, 0.0, 0.0)) == (-1.0, 0.0, 0.0, 0.0)


@pytest.mark.parametrize("pitch", [-pi / 2, -1.0, 0.0, 1.0, pi / 2])
def test_roll_pitch_yaw_round_trip_also_at_the_singularity(pitch: float) -> None:
    """from_rpy(to_rpy(q)) is the same rotation, at pitch = +-90 degrees too, and angles stay in their ranges."""
    for roll, yaw in RNG.uniform(-pi, pi, size=(20, 2)):
        q = rot.from_rpy((roll, pitch, yaw))
        again = rot.to_rpy(q)
        np.testing.assert_allclose(rot.matrix(rot.from_rpy(again)), rot.matrix(q), atol=1e-14)
        assert abs(again[1]) <= pi / 2 + 1e-15
        assert max(abs(again[0]), abs(again[2])) <= pi


def test_body_rates_are_the_derivative_of_the_attitude() -> None:
    """rpy_rates gives omega = 2 log(q(t)^* q(t+h)) / h and alpha its derivative, for angles moving as polynomials."""
    h = 1e-4
    for _ in range(20):
        c = RNG.normal(size=(3, 3))

        def rpy(t: float, c: np.ndarray = c) -> np.ndarray:
            return c[0] + c[1] * t + c[2] * t * t / 2

        def omega(t: float, c: np.ndarray = c) -> np.ndarray:
            return np.array(rot.rpy_rates(c[0] + c[1] * t + c[2] * t * t / 2, c[1] + c[2] * t, c[2])[0])

        w, alpha = rot.rpy_rates(c[0], c[1], c[2])
        step = rot.relative(rot.from_rpy(rpy(-h)), rot.from_rpy(rpy(h)))
        np.testing.assert_allclose(w, np.array(rot.log(step)) / (2 * h), atol=2e-6)
        np.testing.assert_allclose(alpha, (omega(h) - omega(-h)) / (2 * h), atol=2e-6)


@pytest.mark.parametrize("bad", [(0.0, 0.0, 0.0, 0.0), (np.nan, 0.0, 0.0, 1.0), (np.inf, 0.0, 0.0, 1.0)])
def test_a_quaternion_without_direction_is_refused(bad: tuple[float, ...]) -> None:
    """Zero, NaN and infinity are no rotation; any other length is scaled to one."""
    with pytest.raises(SpecError, match="where: not a rotation"):
        rot.normalized(bad, "where")
    np.testing.assert_allclose(rot.normalized((0.0, 3.0, 0.0, 4.0)), (0.0, 0.6, 0.0, 0.8), rtol=1e-15)
