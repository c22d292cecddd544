"""Which plots a log gets: desired and measured motion, the torques, what the law shows and whether physics was kept."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from space_robot_bringup.judge.metrics import Matrix, deviations
from space_robot_bringup.judge.verdict import INTEGRATION_ERROR, PLANT_BOUNDS
from space_robot_description.robot import Robot
from space_robot_description.rotations import EULER, to_rpy
from space_robot_description.spec import ReactionWheels
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.log.arrays import LogArrays
from space_robot_report.block_names import block_names
from space_robot_report.pages.plots import Plot, Trace, lines
from space_robot_report.pages.telemetry import varying

RPY, XYZ = ("roll", "pitch", "yaw"), ("x", "y", "z")
# A legend of more lines than this hides the plot.
MAX_LEGEND = 14
# Drawn under headings of their own.
SHOWN = (
    "true_configuration",
    "true_velocity",
    "applied_wrench",
    "applied_effort",
    "wheel_momentum",
    "momentum_residual",
    "energy_residual",
    "quaternion_residual",
    INTEGRATION_ERROR,
)
# The residual of a run that lost nothing at all still has a place on a logarithmic axis.
FLOOR = 1e-18


def motion_plots(
    arrays: LogArrays, joints: Sequence[str], robot: Robot | None, *, whole: bool = True, desired: bool = True
) -> Iterator[Plot]:
    """Desired and actual values and their difference: the truth where the plant tells it, else the measurement.

    Args:
        arrays: of a log.
        joints: their names.
        robot: None where it is not known.
        whole: every tick is there. Between ticks that are not, a robot may turn more than once: its angles then stay
            within a turn.
        desired: it is known what was desired.
    """
    time, truth = arrays.time, arrays.plant.get("true_configuration", arrays.q)
    prismatic = np.array(robot.prismatic if robot else [False] * len(joints), dtype=bool)
    scale = np.where(prismatic, 1.0, np.degrees(1.0))
    unit = "m" if prismatic.all() and prismatic.size else "deg, m" if prismatic.any() else "deg"
    if not desired:
        yield Plot("Base attitude [deg]", lines(time, _attitude(truth, whole), RPY))
        yield Plot("Base position [m]", lines(time, truth[:, :3], XYZ))
        yield Plot(f"Joints [{unit}]", lines(time, truth[:, 7:] * scale, joints))
        return
    errors = deviations(truth, arrays.q_d)
    turned = np.degrees(errors[:, 3:6])
    yield _followed(f"Base attitude, {EULER} [deg]", time, _attitude(truth, whole), _attitude(arrays.q_d, whole), RPY)
    angle = Trace("angle", time, np.linalg.norm(turned, axis=1), "#1d2329")
    yield Plot(
        "Attitude error, rotation vector in the reference's axes [deg]",
        [*lines(time, turned, [f"about {axis}" for axis in XYZ]), angle],
    )
    if robot is None or robot.base_mode == "free_flying":
        yield _followed("Base position [m]", time, truth[:, :3], arrays.q_d[:, :3], XYZ)
        yield Plot("Base position error [m]", lines(time, errors[:, :3], XYZ))
    yield _followed(f"Joints [{unit}]", time, truth[:, 7:] * scale, arrays.q_d[:, 7:] * scale, joints)
    yield Plot(f"Joint errors [{unit}]", lines(time, errors[:, 6:] * scale, joints))


def effort_plots(arrays: LogArrays, joints: Sequence[str], robot: Robot | None) -> Iterator[Plot]:
    """What it took, against what the actuators have."""
    time = arrays.time
    wrench = arrays.plant.get("applied_wrench", arrays.wrench)
    effort = arrays.plant.get("applied_effort", arrays.effort_command)
    note = "Solid: applied, the mean over the period that ended there. Dotted: commanded."
    torque = _answered("Base torque [N m]", time, wrench[:, 3:], arrays.wrench[:, 3:], XYZ, note)
    yield replace(torque, levels=_torque_limits(robot))
    if robot is None or robot.base_mode == "free_flying":
        yield _answered("Base force [N]", time, wrench[:, :3], arrays.wrench[:, :3], XYZ, note)
    if robot is not None:
        share, commanded = effort / robot.effort_limit, arrays.effort_command / robot.effort_limit
        said = ", ".join(f"{name} {limit:g}" for name, limit in zip(joints, robot.effort_limit, strict=True))
        limits = {"limit": 1.0, "-limit": -1.0}
        plot = _answered(
            "Joint efforts over their limits [-]", time, share, commanded, joints, f"{note} Limits: {said}."
        )
        yield replace(plot, levels=limits if np.abs(commanded).max(initial=0.0) > 0.3 else {})
    yield _answered("Joint efforts [N m or N]", time, effort, arrays.effort_command, joints, note)
    if "wheel_momentum" in arrays.plant:
        yield _wheels(time, arrays.plant["wheel_momentum"], robot)
    if arrays.wheel_momentum is not None:
        yield Plot("Momentum of the wheels as measured [N m s]", lines(time, arrays.wheel_momentum, XYZ))


def conservation_plots(arrays: LogArrays) -> Iterator[Plot]:
    """How far the plant deviates from conservation, against what the verdict allows."""
    for label, allowed in PLANT_BOUNDS.items():
        if label not in arrays.plant:
            continue
        block = np.maximum(np.abs(arrays.plant[label]), FLOOR)
        names = ("linear", "angular") if block.shape[1] == 2 else ("",) * block.shape[1]
        title = f"{label.replace('_', ' ').capitalize()} {'[rad or m]' if label == INTEGRATION_ERROR else '[-]'}"
        yield Plot(title, lines(arrays.time, block, names), levels={"allowed": allowed}, log=True)


def telemetry_plots(time: Vector, blocks: Mapping[str, Matrix], joints: Sequence[str] = ()) -> Iterator[Plot]:
    """Every block of telemetry that changes, under its own name, its numbers under those of axes and joints."""
    for label, block in varying(blocks, SHOWN).items():
        names = block_names(block.shape[1], joints)
        yield Plot(label, lines(time, block, names, legend=len(names) <= MAX_LEGEND))


def _wheels(time: Vector, momentum: Matrix, robot: Robot | None) -> Plot:
    torque = robot.actuators.base_torque if robot is not None else None
    levels: dict[str, float] = {}
    if isinstance(torque, ReactionWheels) and np.abs(momentum).max() > 0.3 * torque.momentum:
        levels = {"capacity": torque.momentum, "-capacity": -torque.momentum}
    note = f"One wheel holds {torque.momentum:g} N m s." if isinstance(torque, ReactionWheels) else ""
    names = [f"wheel {index + 1}" for index in range(momentum.shape[1])]
    return Plot("Wheel momentum [N m s]", lines(time, momentum, names), levels, note=note)


def _torque_limits(robot: Robot | None) -> dict[str, float]:
    """Limits that are the same about every axis; wheels have theirs per wheel."""
    if robot is None:
        return {}
    torque = robot.actuators.base_torque
    if isinstance(torque, ReactionWheels):
        return {"one wheel": torque.torque, "-one wheel": -torque.torque}
    limit = torque.limit[0]
    return {"limit": limit, "-limit": -limit} if set(torque.limit) == {limit} else {}


def _followed(title: str, time: Vector, values: Matrix, wanted: Matrix, names: Sequence[str]) -> Plot:
    dotted = [replace(trace, name="") for trace in lines(time, wanted, names, dash="dot")]
    return Plot(title, [*lines(time, values, names), *dotted], note="Dotted: desired.")


def _answered(title: str, time: Vector, values: Matrix, commanded: Matrix, names: Sequence[str], note: str) -> Plot:
    dotted = [replace(trace, name="") for trace in lines(time, commanded, names, dash="dot", steps="after")]
    return Plot(title, [*dotted, *lines(time, values, names, steps="before")], note=note)


def _attitude(q: Matrix, whole: bool) -> Matrix:
    """(K, 3) roll, pitch, yaw [deg], of a whole log without the jumps of a full turn."""
    angles = np.array([to_rpy(row[3:7]) for row in q])
    return np.degrees(np.unwrap(angles, axis=0) if whole else angles)
