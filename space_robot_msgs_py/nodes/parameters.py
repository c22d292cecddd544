"""What a node runs with as ROS parameters: read-only, but for the few that may change during the run."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor, SetParametersResult
from rclpy.context import Context
from rclpy.exceptions import InvalidParameterValueException
from rclpy.node import Node
from rclpy.parameter import Parameter

from space_robot_msgs_py.errors import SpaceRobotError, SpecError
from space_robot_msgs_py.nodes.fill import fill
from space_robot_msgs_py.parameters import ParameterRow, not_shown

# What ROS itself reads from the same place.
RESERVED = ("use_sim_time", "qos_overrides.", "start_type_description_service")
# A recorded reference may have thousands of numbers; a parameter is for people.
MAX_CHARACTERS, MAX_NUMBERS, EXCERPT = 20_000, 2000, 200


class NodeParameters:
    """Declares rows as parameters and passes on what is set during the run.

    Their values come from the experiment, into which what was given at the start has gone already: see
    ``given_at_start``. A change is refused with the reason that ``apply`` raises; ROS checks type and range before.

    Args:
        node: whose parameters they are.
        apply: takes over changes by name, all or none; raises SpaceRobotError with the reason otherwise.
    """

    def __init__(self, node: Node, apply: Callable[[dict[str, Any]], None]) -> None:
        self._node, self._apply = node, apply
        self._own: set[str] = set()
        self._quiet = False
        node.add_on_set_parameters_callback(self._on_set)

    def declare(self, rows: Iterable[ParameterRow]) -> None:
        """Declare rows; where they are declared already, show the value that dynamic ones have now."""
        with self._quietly():
            for row in rows:
                if row.name not in self._own:
                    self._own.add(row.name)
                    self._node.declare_parameter(row.name, to_ros(row.value), _descriptor(row), ignore_override=True)
                elif row.dynamic:
                    self._node.set_parameters([Parameter(row.name, value=to_ros(row.value))])

    def show(self, name: str, value: Any) -> None:
        """Show a value that the node itself has changed."""
        with self._quietly():
            self._node.set_parameters([Parameter(name, value=to_ros(value))])

    @contextmanager
    def _quietly(self) -> Iterator[None]:
        """What the node says of itself is not passed on to it."""
        self._quiet = True
        try:
            yield
        finally:
            self._quiet = False

    def _on_set(self, parameters: Sequence[Parameter]) -> SetParametersResult:
        changes = {one.name: from_ros(one.value) for one in parameters if one.name in self._own}
        if self._quiet or not changes:
            return fill(SetParametersResult(), successful=True)
        try:
            self._apply(changes)
        except SpaceRobotError as error:
            return fill(SetParametersResult(), successful=False, reason=error)
        return fill(SetParametersResult(), successful=True)


def given_at_start(name: str, context: Context) -> dict[str, Any]:
    """What ``--params-file`` and ``--ros-args -p`` say to a node of this name, but for what ROS itself reads.

    Args:
        name: before remapping.
        context: initialised with the arguments of the command line.

    Raises:
        SpecError: a value is not one that a parameter can have.
    """
    try:
        # Only a node gets them; this one is gone before it is discovered.
        node = Node(
            name,
            context=context,
            automatically_declare_parameters_from_overrides=True,
            start_parameter_services=False,
            enable_rosout=False,
        )
    except InvalidParameterValueException as error:
        raise SpecError(f"{error}", key="--ros-args") from None
    try:
        given = {key: from_ros(one.value) for key, one in node.get_parameters_by_prefix("").items()}
    finally:
        node.destroy_node()
    return {key: value for key, value in given.items() if not key.startswith(RESERVED)}


def to_ros(value: Any) -> Any:
    """The value as ROS knows it; what has no type there (nothing, sections, mixed lists) is JSON text.

    What is too long says so, and is no value when it comes back: see ``is_not_shown``.
    """
    if isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, list | tuple) and value:
        kinds = {type(item) for item in value}
        if kinds <= {int, float}:
            return [float(item) for item in value] if len(value) < MAX_NUMBERS else not_shown(f"{len(value)} numbers")
        if len(kinds) == 1 and kinds <= {str, bool}:
            return list(value)
    text = json.dumps(value)
    return text if len(text) < MAX_CHARACTERS else not_shown(f"{text[:EXCERPT]}...")


def from_ros(value: Any) -> Any:
    """The value of a parameter as plain data; texts stay texts."""
    return value if value is None or isinstance(value, bool | int | float | str) else list(value)


def _descriptor(row: ParameterRow) -> ParameterDescriptor:
    descriptor = fill(
        ParameterDescriptor(),
        description=row.description,
        read_only=not row.dynamic,
        # A gain may be one number or several, whichever of them the experiment has.
        dynamic_typing=row.dynamic,
    )
    if row.lower is not None or row.upper is not None:
        lower = -math.inf if row.lower is None else row.lower
        upper = math.inf if row.upper is None else row.upper
        if isinstance(row.value, float):
            descriptor.floating_point_range = [fill(FloatingPointRange(), from_value=lower, to_value=upper)]
        descriptor.additional_constraints = f"{lower:g} to {upper:g}"
    return descriptor
