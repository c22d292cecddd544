"""Payload and inertia: what is added is what a hand calculation adds, and the impossible is refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from space_robot_description.inertia import check_inertia, inertial_parameters, is_consistent, pseudo_inertia
from space_robot_description.load import load_robot
from space_robot_description.payload import Payload, attach_payload, known_part
from space_robot_description.robot_spec import INERTIA_KEYS, Pose
from space_robot_msgs_py.errors import InertiaError, SpecError
from space_robot_msgs_py.interfaces import Vector

COM = (0.05, -0.02, 0.11)
TENSOR = (0.4, 0.5, 0.6, 0.01, -0.02, 0.03)
TURN = (0.3, -0.2, 0.5)


def _matrix(entries: tuple[float, ...]) -> Vector:
    ixx, iyy, izz, ixy, ixz, iyz = entries
    return np.array([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]])


def _steiner(mass: float, offset: Vector) -> Vector:
    return mass * (offset @ offset * np.eye(3) - np.outer(offset, offset))


@pytest.mark.parametrize("frame", ["tool", "link8", "joint8"])
def test_payload_is_added_by_the_parallel_axis_theorem(frame: str) -> None:
    """The holding body gets the sum of masses, first moments and inertias about its joint, by hand."""
    robot = load_robot("servicer")
    pose = Pose(xyz=(0.1, 0.2, 0.3), rpy=TURN)
    loaded = attach_payload(robot, Payload(mass=40.0, com=COM, inertia=TENSOR, frame=frame, pose=pose))
    turn = pin.rpy.rpyToMatrix(np.array(TURN))
    origin = np.array([0.3, 0, 0]) if frame == "tool" else np.zeros(3)
    com = origin + np.array(pose.xyz) + turn @ np.array(COM)
    about_joint = turn @ _matrix(TENSOR) @ turn.T + _steiner(40.0, com)
    (ixx, ixy, ixz), (_, iyy, iyz), (_, _, izz) = about_joint
    expected = inertial_parameters(robot)
    expected[8] += [40.0, *(40.0 * com), ixx, ixy, iyy, ixz, iyz, izz]
    np.testing.assert_allclose(inertial_parameters(loaded), expected, rtol=1e-13, atol=1e-13)


def test_payload_leaves_the_given_robot_alone() -> None:
    """Attaching a payload does not change the robot it starts from."""
    robot = load_robot("mini")
    before = inertial_parameters(robot)
    attach_payload(robot, Payload(mass=3.0))
    np.testing.assert_array_equal(inertial_parameters(robot), before)


def test_payload_on_the_satellite() -> None:
    """A payload may be fixed to the base as well."""
    loaded = attach_payload(load_robot("mini"), Payload(mass=2.0, frame="base_link"))
    assert inertial_parameters(loaded)[0, 0] == 32.0


BAD = {
    "massless": ({"mass": 0.0, "inertia": TENSOR}, "mass is not positive"),
    "negative": ({"mass": -1.0}, "mass is not positive"),
    "triangle": ({"mass": 0.1, "inertia": (50.0, 60.0, 150.0)}, "triangle inequality"),
    "not positive": ({"mass": 1.0, "inertia": (1.0, 1.0, -0.1)}, "not positive definite"),
}


@pytest.mark.parametrize("case", BAD)
def test_impossible_payloads_are_refused(case: str) -> None:
    """A payload without mass or with an impossible inertia is an InertiaError that names the payload."""
    fields, message = BAD[case]
    with pytest.raises(InertiaError, match=f"link payload: .*{message}"):
        attach_payload(load_robot("mini"), Payload.model_validate(fields))


def test_unknown_payload_frame_shows_the_nearest() -> None:
    """A frame that is not there is refused with the nearest names."""
    with pytest.raises(SpecError, match=r"payload\.frame: no such link or joint; got 'antena'; accepted: antenna"):
        attach_payload(load_robot("mini"), Payload(mass=1.0, frame="antena"))


moments = st.floats(0.01, 10.0)


@given(values=st.tuples(moments, moments, moments), seed=st.integers(0, 1000))
def test_pseudo_inertia_and_triangle_inequality_agree(values: tuple[float, ...], seed: int) -> None:
    """A body has a positive definite pseudo-inertia exactly if its principal moments meet the triangle inequality."""
    rng = np.random.default_rng(seed)
    turn = pin.Quaternion(rng.normal(size=4)).normalized().matrix()
    inertia, com = turn @ np.diag(values) @ turn.T, rng.normal(size=3) * 0.1
    about_origin = inertia + _steiner(2.0, com)
    (ixx, ixy, ixz), (_, iyy, iyz), (_, _, izz) = about_origin
    parameters = np.array([2.0, *(2.0 * com), ixx, ixy, iyy, ixz, iyz, izz])
    small, middle, large = sorted(values)
    assume(abs(small + middle - large) > 1e-6)
    assert is_consistent(parameters) == (small + middle > large)
    if is_consistent(parameters):
        check_inertia("body", 2.0, com, 0.5 * (inertia + inertia.T))
    else:
        with pytest.raises(InertiaError, match="triangle"):
            check_inertia("body", 2.0, com, 0.5 * (inertia + inertia.T))


def test_pseudo_inertia_is_the_second_moment_matrix() -> None:
    """The pseudo-inertia of a cloud of point masses is the sum of m [r; 1] [r; 1]^T."""
    rng = np.random.default_rng(3)
    points, masses = rng.normal(size=(6, 3)), rng.uniform(0.5, 1.0, 6)
    homogeneous = np.column_stack([points, np.ones(6)])
    total: Any = sum(
        (pin.Inertia(m, p, np.zeros((3, 3))) for m, p in zip(masses, points, strict=True)), pin.Inertia.Zero()
    )
    expected = (homogeneous.T * masses) @ homogeneous
    np.testing.assert_allclose(pseudo_inertia(total.toDynamicParameters()), expected, atol=1e-13)


@pytest.mark.parametrize(
    ("mass", "com", "inertia", "message"),
    [
        (np.nan, np.zeros(3), np.eye(3), "mass is not finite"),
        (1.0, np.array([0, np.inf, 0]), np.eye(3), "com is not finite"),
        (1.0, np.zeros(3), np.diag([1, 1, np.nan]), "inertia is not finite"),
        (1.0, np.zeros(3), np.array([[1, 0.1, 0], [0, 1, 0], [0, 0, 1.0]]), "not symmetric"),
    ],
)
def test_check_inertia_names_link_and_condition(mass: float, com: Vector, inertia: Vector, message: str) -> None:
    """Whatever makes a body impossible is named together with its link."""
    with pytest.raises(InertiaError, match=f"link tank: {message}|link tank: inertia is {message}"):
        check_inertia("tank", mass, com, inertia)


@pytest.mark.parametrize("inertia", [TENSOR, TENSOR[:3], dict(zip(INERTIA_KEYS, TENSOR, strict=True))])
def test_a_known_part_of_a_payload_scales_mass_and_inertia_and_keeps_the_place(inertia: Any) -> None:
    """Half a payload added twice is the payload, whatever way its inertia is written."""
    robot = load_robot("servicer")
    payload = Payload(mass=40.0, com=COM, inertia=inertia, pose=Pose(xyz=(0.1, 0.2, 0.3), rpy=TURN))
    half = known_part(payload, 0.5)
    assert (half.mass, half.com, half.pose) == (20.0, payload.com, payload.pose)
    twice = inertial_parameters(attach_payload(attach_payload(robot, half), half))
    np.testing.assert_allclose(twice, inertial_parameters(attach_payload(robot, payload)), rtol=1e-14, atol=1e-14)
