"""The stage between command and plant: what acts in a period, with the faults of that tick on it."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from space_robot_description.kernel.arrays import LOCKED, RobotArrays
from space_robot_description.mass_matrix import mass_matrix
from space_robot_msgs_py.interfaces import Vector
from space_robot_sim.faults.base import Actuation, ActuationFault
from space_robot_sim.faults.plan import FaultPlan
from space_robot_sim.kernel.allocation import Capability


class Acts(NamedTuple):
    """What the plant obeys in one period.

    Attributes:
        command: (6+n,) generalised force asked of the actuators [N, N m].
        able: what they can do.
        arrays: the robot, with its motors and brakes.
    """

    command: Vector
    able: Capability
    arrays: RobotArrays


class ActuationStage:
    """Changes command, actuators, motors and brakes by the faults that act.

    Args:
        plan: of the run.
        joint_names: (n) in model order.
        able: what the actuators can do without faults.
        period: control period [s].
    """

    def __init__(self, plan: FaultPlan, joint_names: tuple[str, ...], able: Capability, period: float) -> None:
        self._planned = plan.of(ActuationFault)
        self._names, self._able, self._period = joint_names, able, period
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
            return Acts(command, self._able, arrays)
        now = self._without_faults(command, wheels, arrays)
        for one in acting:
            assert isinstance(one.fault, ActuationFault)
            if one.first == tick:
                self._memories[one.index].clear()
            one.fault.act(now, self._memories[one.index])
        tree = arrays.tree.copy()
        tree[1:, LOCKED] = now.locked
        able = self._able._replace(
            limit=now.limit,
            share=now.share,
            wheel_limit=now.wheel_limit,
            disturbed=1,
            push=now.push,
            outside=now.outside,
        )
        return Acts(now.command, able, arrays._replace(tree=tree, motors=now.motors))

    def _without_faults(self, command: Vector, wheels: Vector, arrays: RobotArrays) -> Actuation:
        able = self._able
        return Actuation(
            joint_names=self._names,
            period=self._period,
            command=command.copy(),
            limit=able.limit.copy(),
            motors=arrays.motors.copy(),
            locked=np.zeros(len(self._names)),
            share=able.share.copy(),
            wheel_limit=able.wheel_limit.copy(),
            wheels=wheels,
            push=np.zeros(wheels.size),
            outside=np.zeros(6),
        )


def brake(model: Any, q: Vector, v: Vector, held: npt.NDArray[np.int64]) -> tuple[Vector, float]:
    """Stop joints at once by an impulse of their brakes, which is internal: momentum is kept, energy is lost.

    M (v+ - v) = S^T p and S v+ = 0, where S picks the held joints and p is the impulse in them.

    Args:
        model: ``pin.Model`` of the robot.
        q: (7+n,) configuration.
        v: (6+n,) velocity.
        held: (n,) not zero where a brake holds.

    Returns:
        (6+n,) velocity after it, and the work of the brakes [J].
    """
    rows = 6 + np.flatnonzero(held)
    mass = mass_matrix(model, q)
    picks = np.zeros((rows.size, v.size))
    picks[np.arange(rows.size), rows] = 1.0
    response = np.linalg.solve(mass, picks.T)
    after = v - response @ np.linalg.solve(picks @ response, v[rows])
    after[rows] = 0.0
    return after, float(0.5 * (after @ mass @ after - v @ mass @ v))
