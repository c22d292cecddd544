"""Numbers that judge a run, from its ticks alone: the log is all they need."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from space_robot_msgs_py.errors import NonFiniteError
from space_robot_msgs_py.interfaces import NANOSECONDS, Tick, Vector
from space_robot_msgs_py.log.arrays import stack_telemetry

Matrix = npt.NDArray[np.float64]

SETTLING_BAND = 0.02
BASE_AXES = ("base/x", "base/y", "base/z", "base/roll", "base/pitch", "base/yaw")
PER_AXIS = ("final_error", "max_error", "rms_error", "settling_time", "overshoot")
PER_RUN = (
    "saturation_share",
    "momentum_residual",
    "energy_residual",
    "quaternion_residual",
    "effort_integral",
    "joint_limit",
)
PLANT_BLOCKS = (
    "true_configuration",
    "saturation",
    "applied_wrench",
    "applied_effort",
    "momentum_residual",
    "energy_residual",
    "quaternion_residual",
    "joint_limit",
)
STILL = 1e-9
MOVED = 1e-6


@dataclass(frozen=True, eq=False, slots=True)
class Axis:
    """How one axis followed its reference; rotations in [deg], lengths (of prismatic joints, too) in [m].

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


def measure(
    ticks: Iterable[Tick],
    joint_names: Sequence[str],
    *,
    base_translation: bool,
    prismatic: Sequence[bool] = (),
    bands: Mapping[str, float] | None = None,
) -> RunMetrics:
    """Judge a run by its true motion.

    Args:
        ticks: all ticks in order; at least one.
        joint_names: for the names of axes.
        base_translation: also judge the base position (free-flying).
        prismatic: (n) True where a joint is a length; empty: all are angles.
        bands: axis to the half width of its settling band [deg or m], instead of 2 % of its travel.

    Raises:
        NonFiniteError: there is no tick, or a number is not finite.
        LayoutError: a block of the plant's telemetry is missing, or its layout changes.
    """
    rows = list(ticks)
    if not rows:
        raise NonFiniteError(
            "a run without a complete tick cannot be judged", key="ticks", value=0, accepted="at least 1"
        )
    time = np.array([tick.stamp for tick in rows]) / NANOSECONDS
    plant = stack_telemetry([tick.sample.telemetry for tick in rows], PLANT_BLOCKS)
    truth = plant["true_configuration"]
    desired = np.array([tick.reference.q for tick in rows])
    moving = np.abs(np.array([tick.reference.v for tick in rows])).max(axis=1) > STILL
    errors, from_goal = deviations(truth, desired), deviations(truth, np.repeat(desired[-1:], len(rows), axis=0))
    names = axis_names(joint_names, base_translation=True)
    lengths = [True] * 3 + [False] * 3 + list(prismatic or [False] * len(joint_names))
    units = ["m" if length else "deg" for length in lengths]
    scale = np.where(lengths, 1.0, np.degrees(1.0))
    width = bands or {}
    axes = tuple(
        _axis(
            names[i], units[i], time, errors[:, i] * scale[i], from_goal[:, i] * scale[i], moving, width.get(names[i])
        )
        for i in range(0 if base_translation else 3, len(names))
    )
    return _with_totals(plant, time, axes)


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
    angle, far = 2.0 * np.arctan2(length, np.abs(w)), length > 0.0
    out: Matrix = vectors * np.divide(angle, length, out=np.full(length.size, 2.0), where=far)[:, None]
    return out


def _axis(
    name: str,
    unit: str,
    time: Vector,
    error: Vector,
    from_goal: Vector,
    moving: npt.NDArray[np.bool_],
    band: float | None,
) -> Axis:
    travel = abs(from_goal[0])
    settling: float | None = None
    overshoot: float | None = None
    if travel > MOVED and not moving[-1]:
        outside = np.flatnonzero(np.abs(from_goal) > (SETTLING_BAND * travel if band is None else band))
        if outside.size == 0 or outside[-1] + 1 < time.size:
            settling = float(time[outside[-1] + 1] - time[0]) if outside.size else 0.0
        overshoot = float(max(0.0, (-np.sign(from_goal[0]) * from_goal).max()) / travel * 100.0)
    return Axis(
        name=name,
        unit=unit,
        travel=float(travel),
        final_error=float(abs(error[-1])),
        max_error=float(np.abs(error).max()),
        rms_error=float(np.sqrt(np.mean(error**2))),
        settling_time=settling,
        overshoot=overshoot,
    )


def _with_totals(plant: Mapping[str, Matrix], time: Vector, axes: tuple[Axis, ...]) -> RunMetrics:
    saturated = plant["saturation"].max(axis=1, initial=0.0) > 0.0
    torque = np.abs(plant["applied_wrench"][:, 3:]).sum(axis=1) + np.abs(plant["applied_effort"]).sum(axis=1)
    period = np.diff(time, prepend=time[0])
    metrics = RunMetrics(
        ticks=time.size,
        simulated_time=float(time[-1] - time[0]),
        axes=axes,
        saturation_share=float(np.mean(saturated[1:] if time.size > 1 else saturated)),
        momentum_residual=_largest(plant["momentum_residual"]),
        energy_residual=_largest(plant["energy_residual"]),
        quaternion_residual=_largest(plant["quaternion_residual"]),
        effort_integral=float(torque @ period),
        joint_limit=_largest(plant["joint_limit"]),
    )
    for key, value in metrics.flat().items():
        if value is not None and not np.isfinite(value):
            raise NonFiniteError("a metric is not finite", key=key, value=value, accepted="a finite number")
    return metrics


def _largest(block: Matrix) -> float:
    return float(np.max(np.abs(block), initial=0.0))
