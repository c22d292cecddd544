"""From the reference of an experiment file to its object."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, assert_never

from space_robot_control.references.end_effector import end_effector
from space_robot_control.references.harmonic import harmonic
from space_robot_control.references.points import Hold, PointToPoint, Step
from space_robot_control.references.profile import nanoseconds
from space_robot_control.references.recorded import Recorded
from space_robot_control.references.spec import (
    EndEffectorSpec,
    HarmonicSpec,
    HoldSpec,
    LiveSpec,
    QuinticSpec,
    RecordedSpec,
    ReferenceSpec,
    StepSpec,
    WaypointsSpec,
)
from space_robot_control.references.targets import configuration, initial_configuration
from space_robot_control.references.waypoints import waypoints
from space_robot_description.robot import Robot
from space_robot_description.spec import Strict
from space_robot_description.validation import validate
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import ReferenceSource, Vector


class _Section(Strict):
    reference: ReferenceSpec


def make_reference(
    spec: ReferenceSpec | Mapping[str, Any], robot: Robot, initial_q: Vector, key: str = "reference"
) -> ReferenceSource:
    """Build a reference.

    Args:
        spec: one of the typed specs, or a mapping with ``kind`` as read from a file.
        robot: for joint names and limits.
        initial_q: (7+n,) configuration at the start of the run [m, -, rad].
        key: what to call the reference in an error.

    Returns:
        A pure function of the stamp: exact configuration, velocity and acceleration.

    Raises:
        SpecError: the reference is not possible: unknown keys or joints, sizes, times, joint limits.
        CommandError: the initial configuration does not fit the robot.
        NonFiniteError: a number is not finite.
    """
    if isinstance(spec, Mapping):
        spec = validate(_Section, {"reference": dict(spec)}, "").reference
    q = initial_configuration(initial_q, robot)
    match spec:
        case HoldSpec():
            return Hold(configuration(spec, robot, q, key))
        case StepSpec():
            return Step(q, configuration(spec, robot, q, key), nanoseconds(spec.time, f"{key}.time"))
        case QuinticSpec():
            start, duration = nanoseconds(spec.start, f"{key}.start"), nanoseconds(spec.duration, f"{key}.duration")
            return PointToPoint(q, configuration(spec, robot, q, key), start, duration)
        case HarmonicSpec():
            return harmonic(spec, robot, q, key)
        case WaypointsSpec():
            return waypoints(spec, robot, q, key)
        case EndEffectorSpec():
            return end_effector(spec, robot, q, key)
        case RecordedSpec():
            return _recorded(spec, robot, key)
        case LiveSpec():
            # What it is until something comes, and all that a run without a graph has of it; see ``LiveReference``.
            return Hold(q)
        case _:
            assert_never(spec)


def _recorded(spec: RecordedSpec, robot: Robot, key: str) -> Recorded:
    for name, rows, width in (("q", spec.q, 7 + robot.n), ("v", spec.v, 6 + robot.n), ("a", spec.a, 6 + robot.n)):
        for index, row in enumerate(rows):
            if len(row) != width:
                accepted = f"{width} for {robot.n} joints"
                raise SpecError(
                    "wrong number of columns", key=f"{key}.{name}.{index}", value=len(row), accepted=accepted
                )
    return Recorded.from_arrays(spec.stamps, spec.q, spec.v, spec.a, key)
