"""Roll, pitch and yaw in degrees, derived from quaternions and standing beside them in every log."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from space_robot_description.rotations import from_rpy, to_rpy
from space_robot_msgs_py.attitude import AttitudeAngles, rpy_degrees
from space_robot_msgs_py.codec.codecs import ReferenceCodec
from space_robot_msgs_py.codec.generic import canonical_message, parse
from space_robot_msgs_py.interfaces import Reference
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.log.writer import LogSink
from space_robot_msgs_py.topics import ATTITUDE, REFERENCE_ATTITUDE
from tests.support import values


@pytest.mark.parametrize("seed", range(20))
def test_the_angles_are_those_of_the_rest_of_the_project(seed: int) -> None:
    """Of any quaternion, whatever its length and sign."""
    rng = np.random.default_rng(seed)
    quaternion = rng.normal(size=4)
    found = rpy_degrees(*quaternion.tolist())
    assert found == pytest.approx(np.degrees(to_rpy(quaternion / np.linalg.norm(quaternion))), abs=1e-9)
    assert rpy_degrees(*(-3.0 * quaternion).tolist()) == pytest.approx(found, abs=1e-9)


def test_straight_up_and_what_is_no_rotation() -> None:
    """At 90 deg of pitch round-off is no error; zeros and what is not finite have no angles."""
    up = rpy_degrees(*from_rpy(np.array([0.0, math.pi / 2, 0.0])))
    assert up is not None
    assert up[1] == pytest.approx(90.0, abs=1e-5)
    for nothing in (0.0, math.nan, math.inf):
        assert rpy_degrees(nothing, nothing, nothing, nothing) is None


def test_every_tick_of_a_log_has_measured_and_desired_angles(tmp_path: Path) -> None:
    """They are those of its state and its reference, in canonical bytes, under its stamp."""
    ticks = values.run_ticks(5)
    sink = LogSink(tmp_path / "run", values.HEADER)
    for tick in ticks:
        sink.record(tick)
    sink.close("completed")
    reader = LogReader(tmp_path / "run")
    for topic, wanted in (
        (ATTITUDE, [(tick.stamp, tick.sample.state.q) for tick in ticks]),
        (REFERENCE_ATTITUDE, [(tick.stamp, tick.reference.q) for tick in ticks]),
    ):
        found = [(stamp, raw) for name, stamp, raw in reader.messages() if name == topic.name]
        for (stamp, raw), (at, q) in zip(found, wanted, strict=True):
            message = parse(topic.type, raw)
            assert canonical_message(topic.type, raw) == raw
            assert (stamp, message.header.frame_id) == (at, "inertial")
            angles = [message.vector.x, message.vector.y, message.vector.z]
            assert tuple(angles) == rpy_degrees(*q[3:7].tolist())
    assert [values.bits(tick) for tick in reader.ticks()] == [values.bits(tick) for tick in ticks]


def test_what_is_no_odometry_of_ours_has_no_angles() -> None:
    """Another message, another frame, or nothing."""
    base, accel, _ = ReferenceCodec(("a",)).encode(Reference(0, np.eye(1, 8, 6)[0], np.zeros(7), np.zeros(7)))
    desired = AttitudeAngles(REFERENCE_ATTITUDE)
    assert desired.of(base) is not None
    assert desired.of(accel) is desired.of(None) is AttitudeAngles(ATTITUDE).of(base) is None
