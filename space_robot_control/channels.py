"""Degrees of freedom of a law without a model, by name: outputs, inputs, limits and nominal response."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from space_robot_control.nominal_model import NominalModel
from space_robot_description.actuation import torque_capacity
from space_robot_description.kernel.linear import inverse
from space_robot_description.robot import Robot
from space_robot_description.validation import nearest
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Vector

BASE = ("x", "y", "z", "roll", "pitch", "yaw")


def joint_channels(joint_names: Sequence[str]) -> tuple[str, ...]:
    """Names of the channels of the joints: their own, with ``joint.`` before those that the base has too."""
    return tuple(f"joint.{name}" if name in BASE else name for name in joint_names)


class Channels:
    """m degrees of freedom by name, one input and one output each: x, y, z, roll, pitch, yaw, and joints.

    A joint that has the name of a degree of freedom of the base is ``joint.roll`` and so on.

    Args:
        robot: the NOMINAL robot.
        outputs: names in any order; empty: all actuated ones that are not held.
        held: joints that are taken as rigid, by name: a grasp, a locked joint.

    Raises:
        SpecError: a name the robot does not have or does not actuate, twice, or held and controlled at once.
    """

    def __init__(self, robot: Robot, outputs: Sequence[str] = (), held: Sequence[str] = ()) -> None:
        joints = joint_channels(robot.joint_names)
        names, floating = [*BASE, *joints], robot.base_mode == "free_floating"
        actuated = names[3:] if floating else names
        for key, given, accepted in (("held", held, joints), ("outputs", outputs, actuated)):
            for name in given:
                if name not in accepted:
                    hint = nearest(name, accepted) or ", ".join(accepted)
                    raise SpecError("cannot be used", key=f"controller.gains.{key}", value=name, accepted=hint)
        if len(set(outputs) | set(held)) != len(outputs) + len(held):
            raise SpecError("a name twice", key="controller.gains.outputs, held", value=[*outputs, *held])
        self.names = tuple(outputs) or tuple(name for name in actuated if name not in held)
        self.index = np.array([names.index(name) for name in self.names], dtype=np.int64)
        self._free = np.array([i for i, name in enumerate(names) if name not in held])
        self._robot = robot
        # A grasp is seen by cameras, and the one sample at the start may be a wrong one.
        self._held = np.array([joints.index(name) for name in held], dtype=np.int64)

    @property
    def size(self) -> int:
        """M."""
        return len(self.names)

    @property
    def joints(self) -> int:
        """Number of joints of the robot."""
        return self._robot.n

    def limits(self) -> Vector:
        """(m,) largest force, torque or effort of each input [N, N m]."""
        force = self._robot.actuators.base_force
        every = [force.limit if force else np.zeros(3), torque_capacity(self._robot)[0], self._robot.effort_limit]
        out: Vector = np.concatenate(every)[self.index]
        return out

    def response(self, model: NominalModel, q: Vector) -> Vector:
        """Return the (m, m) accelerations of the outputs per unit of input at rest, B [1/kg, 1/(kg m2)].

        Held joints stand where the robot file has them and do not move; all others without an input move freely, a
        free-floating base for one.

        Args:
            model: the nominal model.
            q: (7+n,) configuration [m, -, rad].
        """
        if self._held.size:
            q = np.array(q)
            q[7 + self._held] = self._robot.home[self._held]
        whole = inverse(model.mass_matrix(q)[np.ix_(self._free, self._free)])
        chosen = np.searchsorted(self._free, self.index)
        out: Vector = whole[np.ix_(chosen, chosen)]
        return out

    def spread(self, inputs: Vector) -> Vector:
        """Return the (6+n,) generalised force of (m,) inputs."""
        u = np.zeros(6 + self._robot.n)
        u[self.index] = inputs
        return u
