"""The labelled blocks the plant shows beside its state: the truth, its conservation laws and its limits."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from space_robot_description.robot import Robot
from space_robot_msgs_py.interfaces import Telemetry
from space_robot_sim.command_hold import Acting
from space_robot_sim.kernel.period import PlantMemory

BRAKES, UNLOADING = "brakes", "unloading"


class PlantTelemetry:
    """Assembles one array per stamp.

    Blocks: ``true_configuration`` (7+n), ``true_velocity`` (6+n), ``momentum`` (6: linear, angular about the inertial
    origin, wheels included), ``energy`` (kinetic, without the spin of wheels), ``momentum_residual`` (2: linear,
    angular), ``energy_residual``, ``quaternion_residual``, ``wheel_momentum`` (robots with wheels), ``applied_wrench``
    (6, mean), ``applied_effort`` (n, mean), ``saturation`` (6+n, 0 or 1), ``joint_limit`` (n, how far outside [rad or
    m]), ``command_stamp`` (of the command that acted [ns], -1: none), ``force_ignored`` (free-floating robots: 1 if a
    force was commanded), ``integration_error`` (estimated errors of all steps so far, summed [m or rad]), ``brakes``
    (n, only where brakes may close: in the last period 1 closed and holding, -1 closed and slipping, 0 open or none),
    ``unloading`` (4, only where thrusters may unload the wheels: 1 where they did, and their mean torque).

    Args:
        robot: the true robot.
        wheels: number of its reaction wheels.
        estimated: the integration estimates its error.
        braked: brakes may close.
        unloads: thrusters may unload the wheels.

    Attributes:
        labels: of the blocks.
        sizes: of the blocks.
        traits: limits (2, n) of the joints, whether the robot is free-floating, ``estimated``.
    """

    def __init__(
        self, robot: Robot, wheels: int, *, estimated: bool = True, braked: bool = False, unloads: bool = False
    ) -> None:
        n = robot.n
        blocks = {
            "true_configuration": 7 + n,
            "true_velocity": 6 + n,
            "momentum": 6,
            "energy": 1,
            "momentum_residual": 2,
            "energy_residual": 1,
            "quaternion_residual": 1,
        }
        if wheels:
            blocks["wheel_momentum"] = wheels
        blocks |= {"applied_wrench": 6, "applied_effort": n, "saturation": 6 + n, "joint_limit": n, "command_stamp": 1}
        self._floating = robot.base_mode == "free_floating"
        if self._floating:
            blocks["force_ignored"] = 1
        self._estimated = estimated
        if estimated:
            blocks["integration_error"] = 1
        if braked:
            blocks[BRAKES] = n
        if unloads:
            blocks[UNLOADING] = 4
        self.labels, self.sizes = tuple(blocks), tuple(blocks.values())
        self.traits = np.array([robot.joint_lower, robot.joint_upper]), self._floating, estimated
        self._limits, self._n = tuple(zip(robot.joint_lower.tolist(), robot.joint_upper.tolist(), strict=True)), n

    def of(self, stamp: int, acting: Acting, plant: PlantMemory, modes: Sequence[float] = ()) -> Telemetry:
        """Telemetry at a stamp [ns] after a period under the command ``acting``, with the blocks of modes."""
        # On Python floats: at this size several times faster than on arrays.
        joints = plant.y[7 : 7 + self._n].tolist()
        rest = [max(low - x, x - high, 0.0) for x, (low, high) in zip(joints, self._limits, strict=True)]
        rest.append(float(acting.stamp))
        if self._floating:
            rest.append(float(any(acting.u[:3].tolist())))
        if self._estimated:
            rest.append(float(plant.scratch.error[0]))
        rest += modes
        parts = (
            plant.y[: 13 + 2 * self._n],
            plant.now[:7],
            plant.gauges[:4],
            plant.wheels,
            plant.allocation.wrench,
            plant.effort,
            plant.allocation.saturated,
            np.array(rest),
        )
        return Telemetry(stamp, self.labels, self.sizes, np.concatenate(parts))
