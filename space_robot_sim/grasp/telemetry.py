"""The labelled blocks of a robot with a grasp: those every plant shows, and the grasp."""

from __future__ import annotations

import numpy as np

from space_robot_description.robot import Robot
from space_robot_msgs_py.interfaces import Telemetry, Vector
from space_robot_sim.command_hold import Acting
from space_robot_sim.grasp.law import Grasp


class GraspTelemetry:
    """Assembles one array per stamp.

    Blocks: those of ``PlantTelemetry`` (``wheel_momentum`` (3) in the body frame, ``applied_effort`` zero at the grasp,
    which is no motor), ``grasp_effort`` (3: N, N, N m), ``grasp_energy`` (elastic, J), ``command_ignored`` (0 or 1).

    Args:
        robot: the true robot.
        joints: indices of the grasp's joints.
        grasp: its forces.
    """

    def __init__(self, robot: Robot, joints: tuple[int, int, int], grasp: Grasp) -> None:
        self._n, self._joints, self._grasp = robot.n, joints, grasp
        self._lower, self._upper = robot.joint_lower, robot.joint_upper

    def of(
        self,
        stamp: int,
        *,
        motion: Vector,
        grasp: tuple[float, float, float],
        wheels: Vector,
        balance: tuple[Vector, float, Vector],
        quaternion_residual: float,
        applied: Vector,
        acting: Acting,
        limit: Vector,
    ) -> Telemetry:
        """Telemetry at a stamp [ns].

        Args:
            stamp: [ns].
            motion: (13+2n,) true q and v.
            grasp: its bristle [rad], and ``rest`` and ``turning`` of the push.
            wheels: (3,) [N m s].
            balance: momentum, energy and residuals, see ``ConservationBalance``.
            quaternion_residual: before it was made unit [-].
            applied: (6+n,) mean force, torque and motor efforts over the period [N, N m].
            acting: the command that acted.
            limit: (6+n,) of the command, 0 where it does nothing.
        """
        n, (i, j, k), (bristle, rest, turning) = self._n, self._joints, grasp
        momentum, energy, residuals = balance
        q, rates = motion[7 : 7 + n], motion[13 + n :]
        offsets = float(q[i]) - rest, float(q[j])
        forces = self._grasp.forces(*offsets, float(rates[i]), float(rates[j]), float(rates[k]) - turning, bristle)
        return Telemetry.of(
            stamp,
            {
                "true_configuration": motion[: 7 + n],
                "true_velocity": motion[7 + n :],
                "momentum": momentum,
                "energy": energy,
                "momentum_residual": residuals[:2],
                "energy_residual": residuals[2],
                "quaternion_residual": quaternion_residual,
                "wheel_momentum": wheels,
                "applied_wrench": applied[:6],
                "applied_effort": applied[6:],
                "saturation": ((np.abs(acting.u) >= limit) & (limit > 0.0)).astype(np.float64),
                "joint_limit": np.maximum(0.0, np.maximum(self._lower - q, q - self._upper)),
                "command_stamp": float(acting.stamp),
                "grasp_effort": [forces.x, forces.y, forces.torque],
                "grasp_energy": self._grasp.stored(*offsets, bristle),
                "command_ignored": float(acting.u[limit == 0.0].any()),
            },
        )
