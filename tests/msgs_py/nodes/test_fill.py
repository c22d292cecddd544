"""Fields of messages get values of their types."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

pytest.importorskip("rclpy")
from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from nav_msgs.msg import Odometry
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool, Float64

from space_robot_msgs_py.nodes.fill import fill

pytestmark = pytest.mark.ros


def sent(message: Any) -> Any:
    """What a reader gets."""
    return deserialize_message(serialize_message(message), type(message))


def test_what_rclpy_would_send_as_something_else_is_cast() -> None:
    """An int in a float field, numpy's truth values and numbers, lists of them, numbers in texts."""
    assert sent(fill(Float64(), data=1)).data == 1.0
    assert sent(fill(Float64(), data=np.float32(1.5))).data == 1.5
    assert sent(fill(Bool(), data=np.bool_(True))).data is True
    assert sent(fill(Time(), sec=np.int64(3), nanosec=4.0)) == Time(sec=3, nanosec=4)
    joints = sent(fill(JointState(), name=["a", "b"], position=[1, np.float32(2.0)]))
    assert (joints.name, joints.position.tolist()) == (["a", "b"], [1.0, 2.0])
    assert sent(fill(Odometry().pose, covariance=range(36))).covariance.tolist() == list(map(float, range(36)))
    status = fill(DiagnosticStatus(), name=7, level=DiagnosticStatus.WARN)
    assert sent(fill(DiagnosticArray(), status=[status])).status[0].name == "7"


def test_a_field_that_there_is_not_is_an_error() -> None:
    """By its name, where a message object would take any attribute of its own."""
    with pytest.raises(AttributeError, match="Float64 has no field date"):
        fill(Float64(), date=1.0)


def test_messages_check_their_fields_in_tests() -> None:
    """ROS_PYTHON_CHECK_FIELDS is set for every test and every process that one starts."""
    with pytest.raises(AssertionError):
        Float64(data=1)
