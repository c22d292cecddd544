"""The stage between command and plant: what acts in a period, with the faults of that tick on it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from space_robot_description.kernel.arrays import RobotArrays, with_locked_joints
from space_robot_msgs_py.interfaces import Vector
from space_robot_sim.faults.base import Actuation, ActuationFault
from space_robot_sim.faults.plan import FaultPlan
from space_robot_sim.kernel.allocation import Capability


class Acts(NamedTuple):
    """What the plant obeys in one period.

    Attributes:
        command: (6+n,) generalised force asked of the actuators [N, N m].
        able: what they can do.
        arrays: the robot, with its motors and joints that are stuck.
        brakes: (n,) torque of the joints' brakes [N m or N].
    """

    command: Vector
    able: Capability
    arrays: RobotArrays
    brakes: Vector


class ActuationStage:
    """Changes command, actuators, motors and brakes by the faults that act.

    Args:
        plan: of the run.
        joint_names: (n) in model order.
        able: what the actuators can do without faults.
        brakes: (n,) torque of the joints' brakes without faults [N m or N].
        period: control period [s].
    """

    def __init__(
        self, plan: FaultPlan, joint_names: tuple[str, ...], able: Capability, brakes: Vector, period: float
    ) -> None:
        self._planned = plan.of(ActuationFault)
        self._names, self._able, self._brakes, self._period = joint_names, able, brakes, period
        self.reset()

    def reset(self) -> Capability:
        """Forget what faults remember; what the actuators can do without them."""
        self._memories: dict[int, dict[str, float]] = {one.index: {} for one in self._planned}
        return self._able

    def at(self, tick: int, command: Vector, wheels: Vector, arrays: RobotArrays) -> Acts:
        """What acts in the period that begins at a tick; call once per tick, in order.

        Args:
            tick: of the state that the command answers.
            command: (6+n,) commanded generalised force.
            wheels: (k,) momenta of the wheels [N m s].
            arrays: the robot without faults.
        """
        acting = [one for one in self._planned if one.acts(tick)]
        if not acting:
            return Acts(command, self._able, arrays, self._brakes)
        now = self._without_faults(command, wheels, arrays)
        for one in acting:
            assert isinstance(one.fault, ActuationFault)
            if one.first == tick:
                self._memories[one.index].clear()
            one.fault.act(now, self._memories[one.index])
        able = self._able._replace(
            limit=now.limit,
            share=now.share,
            wheel_limit=now.wheel_limit,
            disturbed=1,
            push=now.push,
            outside=now.outside,
        )
        return Acts(now.command, able, with_locked_joints(arrays, now.locked)._replace(motors=now.motors), now.brakes)

    def _without_faults(self, command: Vector, wheels: Vector, arrays: RobotArrays) -> Actuation:
        able = self._able
        return Actuation(
            joint_names=self._names,
            period=self._period,
            command=command.copy(),
            limit=able.limit.copy(),
            motors=arrays.motors.copy(),
            locked=np.zeros(len(self._names)),
            brakes=self._brakes.copy(),
            share=able.share.copy(),
            wheel_limit=able.wheel_limit.copy(),
            wheels=wheels,
            push=np.zeros(wheels.size),
            outside=np.zeros(6),
        )
