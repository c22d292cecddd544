"""A run as arrays over time, under the names of what they are."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields, is_dataclass
from types import MappingProxyType
from typing import Any

import numpy as np
import numpy.typing as npt

from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.log.arrays import LogArrays

XYZ, XYZW = ("x", "y", "z"), ("x", "y", "z", "w")


@dataclass(frozen=True, eq=False, slots=True)
class BaseArrays:
    """The base as measured, K rows.

    Attributes:
        position: (K, 3) of the base origin, inertial frame [m].
        quaternion: (K, 4) x, y, z, w of the attitude, body to inertial [-].
        linear_velocity: (K, 3) of the base origin, body frame [m/s].
        angular_velocity: (K, 3) body frame [rad/s].
        acceleration: (K, 3) inertial acceleration of the base origin, body frame, as an accelerometer reads it [m/s2].
        wheel_momentum: (K, 3) of the reaction wheels, body frame [N m s]; None: it was not measured.
    """

    position: Vector
    quaternion: Vector
    linear_velocity: Vector
    angular_velocity: Vector
    acceleration: Vector
    wheel_momentum: Vector | None = None


@dataclass(frozen=True, eq=False, slots=True)
class JointArrays:
    """The n joints as measured, K rows, columns in the order of ``joint_names``.

    Attributes:
        position: (K, n) [rad or m].
        velocity: (K, n) [rad/s or m/s].
        effort: (K, n) of the motors, mean over the control period that ended [N m or N].
    """

    position: Vector
    velocity: Vector
    effort: Vector


@dataclass(frozen=True, eq=False, slots=True)
class DesiredBase:
    """The base as the reference wants it, K rows; body frame: that of the DESIRED body.

    Attributes:
        position: (K, 3) inertial frame [m].
        quaternion: (K, 4) x, y, z, w, body to inertial [-].
        linear_velocity: (K, 3) body frame [m/s].
        angular_velocity: (K, 3) body frame [rad/s].
        linear_acceleration: (K, 3) derivative of the components of the linear velocity [m/s2].
        angular_acceleration: (K, 3) derivative of the components of the angular velocity [rad/s2].
    """

    position: Vector
    quaternion: Vector
    linear_velocity: Vector
    angular_velocity: Vector
    linear_acceleration: Vector
    angular_acceleration: Vector


@dataclass(frozen=True, eq=False, slots=True)
class DesiredJoints:
    """The n joints as the reference wants them, K rows, columns in the order of ``joint_names``.

    Attributes:
        position: (K, n) [rad or m].
        velocity: (K, n) [rad/s or m/s].
        acceleration: (K, n) [rad/s2 or m/s2].
    """

    position: Vector
    velocity: Vector
    acceleration: Vector


@dataclass(frozen=True, eq=False, slots=True)
class ReferenceArrays:
    """The desired motion: ``base`` and ``joints``."""

    base: DesiredBase
    joints: DesiredJoints


@dataclass(frozen=True, eq=False, slots=True)
class CommandArrays:
    """What the law commanded in answer to the state of the same row.

    Attributes:
        force: (K, 3) on the base at its origin, body frame [N].
        torque: (K, 3) on the base, body frame [N m].
        effort: (K, n) of the joints, columns in the order of ``joint_names`` [N m or N].
    """

    force: Vector
    torque: Vector
    effort: Vector


@dataclass(frozen=True, eq=False, slots=True)
class TelemetryArrays:
    """Blocks of numbers by label, (K, size) each; their units are those of docs/laws.md and docs/plant.md.

    Attributes:
        controller: of the law.
        plant: of the plant, the truth among them (``true_configuration``, ``true_velocity``).
    """

    controller: MappingProxyType[str, Vector]
    plant: MappingProxyType[str, Vector]


@dataclass(frozen=True, eq=False, slots=True)
class RunArrays:
    """All K complete ticks of a run of a robot with n joints; every array is read-only.

    Attributes:
        joint_names: (n) what the columns of joint arrays are.
        stamp: (K,) [ns].
        time: (K,) [s].
        base: measured.
        joints: measured.
        reference: what was desired.
        command: what was commanded.
        telemetry: what law and plant show of themselves.
    """

    joint_names: tuple[str, ...]
    stamp: npt.NDArray[np.int64]
    time: Vector
    base: BaseArrays
    joints: JointArrays
    reference: ReferenceArrays
    command: CommandArrays
    telemetry: TelemetryArrays

    def variables(self) -> Iterator[tuple[str, Vector, tuple[str, ...]]]:
        """Every array (K, size) with a name such as ``base.position``, and what its columns are called.

        Of a block of telemetry only its law knows more than the order of its numbers; a single number needs no name.
        """
        for group in ("base", "joints", "reference", "command", "telemetry"):
            yield from self._variables(group, getattr(self, group))

    def columns(self) -> Iterator[tuple[str, Vector]]:
        """Every number as one column (K,) with a name such as ``base.position.x`` or ``command.effort.joint1``."""
        for name, value, labels in self.variables():
            if not labels:
                yield name, value[:, 0]
            yield from ((f"{name}.{label}", value[:, index]) for index, label in enumerate(labels))

    def _variables(self, name: str, value: Any) -> Iterator[tuple[str, Vector, tuple[str, ...]]]:
        if is_dataclass(value):
            value = {field.name: getattr(value, field.name) for field in fields(value)}
        if value is None:
            return
        if isinstance(value, Mapping):
            for part, inner in value.items():
                yield from self._variables(f"{name}.{part}", inner)
            return
        yield name, value, self._labels(name, value.shape[1])

    def _labels(self, name: str, size: int) -> tuple[str, ...]:
        if name.startswith("telemetry."):
            return tuple(map(str, range(size))) if size != 1 else ()
        if is_of_joints(name):
            return self.joint_names
        return XYZW if name.endswith("quaternion") else XYZ


def is_of_joints(name: str) -> bool:
    """Whether an array has a column per joint, by its name."""
    return "joints" in name.split(".") or name == "command.effort"


def run_arrays(log: LogArrays, joint_names: tuple[str, ...]) -> RunArrays:
    """Name the parts of a log's arrays, which become read-only; nothing is copied.

    Args:
        log: fresh from a log.
        joint_names: the robot's joints in model order.
    """
    for field in fields(log):
        _lock(getattr(log, field.name))
    q_d, v_d, a_d = log.q_d, log.v_d, log.a_d
    return RunArrays(
        joint_names=joint_names,
        stamp=log.stamp,
        time=log.time,
        base=BaseArrays(
            log.q[:, :3], log.q[:, 3:7], log.v[:, :3], log.v[:, 3:6], log.base_acceleration, log.wheel_momentum
        ),
        joints=JointArrays(log.q[:, 7:], log.v[:, 6:], log.effort),
        reference=ReferenceArrays(
            DesiredBase(q_d[:, :3], q_d[:, 3:7], v_d[:, :3], v_d[:, 3:6], a_d[:, :3], a_d[:, 3:6]),
            DesiredJoints(q_d[:, 7:], v_d[:, 6:], a_d[:, 6:]),
        ),
        command=CommandArrays(log.wrench[:, :3], log.wrench[:, 3:], log.effort_command),
        telemetry=TelemetryArrays(MappingProxyType(log.controller), MappingProxyType(log.plant)),
    )


def _lock(arrays: Any) -> None:
    for array in arrays.values() if isinstance(arrays, dict) else (arrays,):
        if array is not None:
            array.setflags(write=False)
