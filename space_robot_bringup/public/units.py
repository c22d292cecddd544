"""The unit of every number of a run, by its name."""

from __future__ import annotations

from collections.abc import Callable

from space_robot_bringup.public.arrays import RunArrays, is_of_joints
from space_robot_msgs_py.log.header import LogHeader
from space_robot_msgs_py.urdf_frames import read_frames

OF_BASE = {
    "position": "m",
    "quaternion": "1",
    "linear_velocity": "m/s",
    "angular_velocity": "rad/s",
    "acceleration": "m/s2",
    "linear_acceleration": "m/s2",
    "angular_acceleration": "rad/s2",
    "force": "N",
    "torque": "N m",
}
TURNING = {"position": "rad", "velocity": "rad/s", "acceleration": "rad/s2", "effort": "N m"}
SLIDING = {"position": "m", "velocity": "m/s", "acceleration": "m/s2", "effort": "N"}


def units_of(header: LogHeader) -> Callable[[str, str], str]:
    """What names the unit of a number of this robot's runs.

    Args:
        header: of the log; its URDF says which joints slide.

    Returns:
        A function of an array's name, such as ``joints.position``, and of a column's, such as ``joint1``. Telemetry has
        the units of docs/laws and docs/plant.md, which it does not know: "".
    """
    _, joints = read_frames(header.urdf)
    sliding = {name for name, joint in joints.items() if joint.prismatic}

    def unit(name: str, label: str) -> str:
        quantity = name.rpartition(".")[2]
        if name.startswith("telemetry."):
            return ""
        if is_of_joints(name):
            return (SLIDING if label in sliding else TURNING)[quantity]
        return OF_BASE[quantity]

    return unit


def column_units(arrays: RunArrays, header: LogHeader) -> dict[str, str]:
    """The unit of every column of a table of ``arrays`` that has one, by its name; see ``RunArrays.columns``."""
    unit = units_of(header)
    named = ((name, label) for name, _, labels in arrays.variables() for label in labels)
    return {"time": "s", "stamp": "ns"} | {f"{name}.{label}": unit(name, label) for name, label in named}
