"""Values on their way to ROS and back."""

from __future__ import annotations

from array import array
from typing import Any

import pytest

pytest.importorskip("rclpy")
from rclpy.parameter import Parameter

from space_robot_description.validation import parse_yaml_value
from space_robot_msgs_py.nodes.parameters import MAX_CHARACTERS, MAX_NUMBERS, from_ros, to_ros
from space_robot_msgs_py.parameters import is_not_shown

pytestmark = pytest.mark.ros


def through_ros(value: Any) -> Any:
    """What is left of a value after the message of ROS."""
    shown = Parameter("name", value=to_ros(value))
    return from_ros(Parameter.from_parameter_msg(shown.to_parameter_msg()).value)


@pytest.mark.parametrize("value", [True, 3, 0.1, "text", [1.0, 2.0], ["a", "b"], [True, False]])
def test_a_parameter_value_round_trips(value: Any) -> None:
    """What has a type in ROS goes through its message and is the same value of the same type."""
    back = through_ros(value)
    assert (back, type(back)) == (value, type(value))


@pytest.mark.parametrize("value", [None, [], {}, {"joint": 0.5}, [{"time": 1.0}]])
def test_a_value_without_a_type_in_ros_comes_back_as_text(value: Any) -> None:
    """The text is one that YAML reads as the same value."""
    back = through_ros(value)
    assert isinstance(back, str)
    assert parse_yaml_value(back, "name") == value


def test_arrays_are_plain_lists() -> None:
    """Whole numbers among others become what the others are, and what ROS gives as an array is a list."""
    assert to_ros([1, 2.5]) == [1.0, 2.5]
    assert from_ros(array("d", [1.0, 2.0])) == [1.0, 2.0]


def test_long_values_are_not_spelt_out() -> None:
    """A recorded reference says how many numbers it has, a long text how it begins: neither is taken for a value."""
    assert to_ros([0.0] * MAX_NUMBERS) == f"not shown: {MAX_NUMBERS} numbers"
    for value in ([0.0] * MAX_NUMBERS, {"key": "x" * MAX_CHARACTERS}):
        assert is_not_shown(to_ros(value))
        assert len(to_ros(value)) < MAX_CHARACTERS
    assert not is_not_shown(to_ros([0.0, 1.0]))
