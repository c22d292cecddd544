"""The metrics of a run that is in memory: as they are measured tick by tick, and by formulas over whole arrays."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from space_robot_bringup.judge.measure import (
    MOVED,
    PLANT_BLOCKS,
    SETTLING_BAND,
    STILL,
    Measurement,
    tick_blocks,
)
from space_robot_bringup.judge.metrics import Axis, Matrix, RunMetrics, axis_names, deviations
from space_robot_msgs_py.interfaces import NANOSECONDS, Tick, Vector
from space_robot_msgs_py.log.arrays import stack_telemetry


def measure(ticks: Iterable[Tick], joint_names: Sequence[str], **options: Any) -> RunMetrics:
    """The metrics of ticks as ``Measurement`` takes them, with its options."""
    measurement = Measurement(joint_names, **options)
    for block in tick_blocks(ticks):
        measurement.add(*block)
    return measurement.result()


def measure_whole(
    rows: Sequence[Tick],
    joint_names: Sequence[str],
    *,
    base_translation: bool,
    prismatic: Sequence[bool] = (),
    bands: Mapping[str, float] | None = None,
) -> RunMetrics:
    """``measure`` of ticks that are all in memory."""
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
    return RunMetrics(
        ticks=time.size,
        simulated_time=float(time[-1] - time[0]),
        axes=axes,
        saturation_share=float(np.mean(saturated[1:] if time.size > 1 else saturated)),
        momentum_residual=_largest(plant["momentum_residual"]),
        energy_residual=_largest(plant["energy_residual"]),
        quaternion_residual=_largest(plant["quaternion_residual"]),
        effort_integral=float(np.sum(torque * period)),
        joint_limit=_largest(plant["joint_limit"]),
        integration_error=_largest(plant["integration_error"]) if "integration_error" in plant else None,
    )


def _largest(block: Matrix) -> float:
    return float(np.max(np.abs(block), initial=0.0))
