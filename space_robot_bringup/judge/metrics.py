"""The numbers a run is judged by: their names, and how far a motion is from where it should be."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from space_robot_msgs_py.kernel.elementary import atan2_rows

Matrix = npt.NDArray[np.float64]

BASE_AXES = ("base/x", "base/y", "base/z", "base/roll", "base/pitch", "base/yaw")
# What the rotations among the axes are; wherever they are shown, this is said.
ROTATIONS = "base/roll, base/pitch, base/yaw: rotation vector from the reference to the base, in the reference's axes"
PER_AXIS = ("final_error", "max_error", "rms_error", "settling_time", "overshoot")
PER_RUN = (
    "saturation_share",
    "momentum_residual",
    "energy_residual",
    "quaternion_residual",
    "effort_integral",
    "joint_limit",
    "integration_error",
)


@dataclass(frozen=True, eq=False, slots=True)
class Axis:
    """How one axis followed its reference; rotations in [deg], lengths (of prismatic joints, too) in [m].

    Those of the base are the components of a rotation vector, see ``ROTATIONS``, and no Euler angles.

    Attributes:
        name: ``base/x``, ``base/roll`` or the joint's name.
        unit: ``m`` or ``deg``.
        travel: how far the reference ends from where the axis began.
        final_error: |error| at the last tick.
        max_error: largest |error| of the run (of a step: the step itself; of an axis that holds: the disturbance).
        rms_error: root mean square error over the whole run.
        settling_time: [s] from the start until the axis stays within its band around the final reference, 2 % of its
            travel where no other was asked for; None where the reference keeps moving, nothing was to move, or it
            never settles.
        overshoot: [% of travel] beyond the final reference; None as above.
    """

    name: str
    unit: str
    travel: float
    final_error: float
    max_error: float
    rms_error: float
    settling_time: float | None
    overshoot: float | None


@dataclass(frozen=True, eq=False, slots=True)
class RunMetrics:
    """The judged run.

    Attributes:
        ticks: number of ticks.
        simulated_time: [s].
        axes: base rotation (and translation of a free-flying robot), then joints.
        saturation_share: share of periods in which at least one channel was at its limit [-].
        momentum_residual: largest relative violation of momentum balance, linear and angular [-].
        energy_residual: largest relative violation of energy balance [-].
        quaternion_residual: largest deviation of the attitude quaternion's norm before normalisation [-].
        effort_integral: integral of the sum of |joint effort| and |base torque| [N m s].
        joint_limit: largest excursion beyond a joint limit [rad or m].
        integration_error: estimated errors of all steps of the plant's integration, summed [rad or m]; None where the
            log does not say.
    """

    ticks: int
    simulated_time: float
    axes: tuple[Axis, ...]
    saturation_share: float
    momentum_residual: float
    energy_residual: float
    quaternion_residual: float
    effort_integral: float
    joint_limit: float
    integration_error: float | None = None

    def flat(self) -> dict[str, float | None]:
        """Every number under one dotted name, e.g. ``base/roll.settling_time``; what ``expect:`` addresses."""
        numbers: dict[str, float | None] = {}
        for axis in self.axes:
            numbers |= {f"{axis.name}.{field}": getattr(axis, field) for field in PER_AXIS}
        return numbers | {field: getattr(self, field) for field in PER_RUN}


def axis_names(joint_names: Sequence[str], *, base_translation: bool) -> list[str]:
    """Names of the axes of a robot: base position (of a free-flying robot), base rotation, joints."""
    return [*BASE_AXES[0 if base_translation else 3 :], *joint_names]


def metric_names(joint_names: Sequence[str], *, base_translation: bool) -> list[str]:
    """Names of all metrics a run of this robot has."""
    axes = axis_names(joint_names, base_translation=base_translation)
    return [f"{axis}.{field}" for axis in axes for field in PER_AXIS] + list(PER_RUN)


def deviations(q: Matrix, goal: Matrix) -> Matrix:
    """How far configurations are from goals.

    Args:
        q: (K, 7+n) configurations.
        goal: (K, 7+n) where they should be.

    Returns:
        (K, 6+n) position error [m], rotation vector from goal to q in the goal's body frame [rad], joint error [rad].
    """
    return np.hstack([q[:, :3] - goal[:, :3], _rotation_vectors(goal[:, 3:7], q[:, 3:7]), q[:, 7:] - goal[:, 7:]])


def _rotation_vectors(goal: Matrix, q: Matrix) -> Matrix:
    """log(R(goal)^T R(q)) the short way, (K, 3): ``rotations.relative`` and ``rotations.log`` of whole runs at once."""
    (a, b), (c, d) = (goal[:, :3], goal[:, 3:]), (q[:, :3], q[:, 3:])
    w = b[:, 0] * d[:, 0] + (a * c).sum(axis=1)
    vectors = (b * c - d * a - np.cross(a, c)) * np.where(w < 0.0, -1.0, 1.0)[:, None]
    length = np.sqrt((vectors * vectors).sum(axis=1))
    angle, far = 2.0 * atan2_rows(length, np.abs(w)), length > 0.0
    out: Matrix = vectors * np.divide(angle, length, out=np.full(length.size, 2.0), where=far)[:, None]
    return out
