"""A robot with all that is flexible in it: its model, its springs, and where what stands in the state."""

from __future__ import annotations

from typing import Any

import numpy as np

from space_robot_description.robot import Robot
from space_robot_description.spec import check_joint_names, expand
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.products import dot
from space_robot_sim.flexible.bodies import KEY, hidden_bodies, with_hidden
from space_robot_sim.flexible.modes import linear_rates
from space_robot_sim.flexible.spec import FlexibilitySpec, JointFlexibility
from space_robot_sim.flexible.springs import ANGLE, DAMPING, ROTOR, SPEED, SPRING_SIZE, STIFFNESS
from space_robot_sim.initial import InitialState


class FlexibleParts:
    """What the flexibility of an experiment is for a robot.

    Args:
        spec: None: everything is rigid.
        robot: the truth, as it starts.

    Attributes:
        hidden: number m of joints that no motor drives; they stand behind the robot's n.
        names: (m,) of them.
        motors: (k,) joints of the robot with a gear that twists.
        more: further states: lost work, angles and rates of these motors; 0 of a rigid robot.
        springs: (n+m, 5) see `kernel.flexible`; (0, 5): all is rigid.
        start: (m,) positions of the hidden joints at the start.
        reads_motors: joint sensors are at the motors.
        rates: eigenvalues of its small motions at home [1/s], see ``linear_rates``; (0,) of a rigid robot.

    Raises:
        SpecError: it does not fit the robot; the message names the key.
        InertiaError: a body cannot exist.
    """

    def __init__(self, spec: FlexibilitySpec | None, robot: Robot) -> None:
        self._bodies, self._joints = () if spec is None else hidden_bodies(spec), robot.n
        joints = [joint for body in self._bodies for joint in body.joints]
        self.hidden, self.names = len(joints), tuple(joint.name for joint in joints)
        self.start: Vector = np.array([joint.start for joint in joints])
        gears = None if spec is None else spec.joints
        self.reads_motors = gears is not None and gears.measured == "motor"
        self.springs: Vector = np.zeros((0, SPRING_SIZE))
        self.motors: tuple[int, ...] = ()
        self.more = 0
        if spec is not None:
            n = robot.n
            self.springs = np.zeros((n + self.hidden, SPRING_SIZE))
            self.springs[n:, : DAMPING + 1] = [[joint.stiffness, joint.damping] for joint in joints] or 0.0
            if gears is not None:
                self.springs[:n, : ROTOR + 1] = _gears(gears, robot)
            self.motors = tuple(np.flatnonzero(self.springs[:n, ROTOR]).tolist())
            self._place_motors(20 + 2 * (n + self.hidden))
        model, home = self.model(robot), np.concatenate([robot.home, np.zeros(self.hidden)])
        self.rates: Vector = linear_rates(model, home, self.springs) if self.more else np.zeros(0)

    def model(self, robot: Robot) -> Any:
        """The ``pin.Model`` of the robot as it is now with all hidden joints."""
        return with_hidden(robot, self._bodies) if self._bodies else robot.model

    @property
    def fastest(self) -> float:
        """Largest eigenvalue of the modes at home [1/s]; 0 of a rigid robot."""
        return float(np.max(np.abs(self.rates), initial=0.0))

    def begin(self, initial: InitialState, y: Vector) -> None:
        """Write the initial state; gears are not twisted, hidden joints are where they start, at rest."""
        n, still = self._joints, np.zeros(self.hidden)
        parts = initial.q, self.start, initial.v, still
        y[: 13 + 2 * (n + self.hidden)] = np.concatenate(parts)
        for joint in self.motors:
            y[int(self.springs[joint, ANGLE])] = initial.q[7 + joint]
            y[int(self.springs[joint, SPEED])] = initial.v[6 + joint]

    def true(self, y: Vector) -> tuple[Vector, Vector]:
        """Configuration (7+n,) and velocity (6+n,) of the robot without what is hidden, in a state y."""
        n, first = self._joints, 7 + self._joints + self.hidden
        return y[: 7 + n], y[first : first + 6 + n]

    def measured(self, y: Vector) -> tuple[Vector, Vector]:
        """The same as sensors are placed to read it: joints at their motors where the experiment says so."""
        q, v = self.true(y)
        if self.reads_motors:
            q, v = q.copy(), v.copy()
            q[7:], v[6:] = self.at_motors(y)
        return q, v

    def at_motors(self, y: Vector) -> tuple[Vector, Vector]:
        """(n,) positions and rates of the motors behind their gears; of rigid joints those of the joint."""
        q, v = self.true(y)
        position, rate = q[7:].copy(), v[6:].copy()
        for joint in self.motors:
            position[joint] = y[int(self.springs[joint, ANGLE])]
            rate[joint] = y[int(self.springs[joint, SPEED])]
        return position, rate

    @property
    def blocks(self) -> dict[str, int]:
        """Label -> size of what the telemetry of a flexible robot has more."""
        found = {f"flexible_{name}": 2 for name in self.names}
        if self.motors:
            found |= {"motor_position": self._joints, "motor_rate": self._joints}
        return found | {"flexible_energy": 1, "dissipated_energy": 1}

    def shown(self, y: Vector) -> tuple[Vector, ...]:
        """The numbers of ``blocks`` in a state y; none of a rigid robot."""
        if not self.more:
            return ()
        first, size = 7 + self._joints, self._joints + self.hidden
        hidden = np.column_stack([y[first : first + self.hidden], y[first + 6 + size : first + 6 + size + self.hidden]])
        motors = self.at_motors(y) if self.motors else ()
        return (hidden.ravel(), *motors, np.array([self._stored(y), y[20 + 2 * size]]))

    def _stored(self, y: Vector) -> float:
        """What springs and rotors hold [J]."""
        size = self._joints + self.hidden
        twist, speed = y[7 : 7 + size].copy(), np.zeros(size)
        for joint in self.motors:
            twist[joint] -= y[int(self.springs[joint, ANGLE])]
            speed[joint] = y[int(self.springs[joint, SPEED])]
        return 0.5 * (dot(self.springs[:, STIFFNESS], twist**2) + dot(self.springs[:, ROTOR], speed**2))

    def _place_motors(self, end: int) -> None:
        """Lost work, then angles, then rates, behind everything else in the state."""
        count = len(self.motors)
        for place, joint in enumerate(self.motors):
            self.springs[joint, ANGLE], self.springs[joint, SPEED] = end + 1 + place, end + 1 + count + place
        self.more = 1 + 2 * count


def _gears(spec: JointFlexibility, robot: Robot) -> Vector:
    """(n, 3) stiffness, damping and rotor inertia behind the gear; zeros of rigid joints.

    Raises:
        SpecError: a joint is not there, slides, or has no rotor.
    """
    names, key = robot.joint_names, f"{KEY}.joints"
    nothing = [0.0] * robot.n
    stiffness = expand(spec.stiffness, names, f"{key}.stiffness", nothing)
    damping = expand(spec.damping, names, f"{key}.damping", nothing)
    rotor = expand(spec.rotor_inertia, names, f"{key}.rotor_inertia", nothing)
    ratio = expand(spec.gear_ratio, names, f"{key}.gear_ratio", [1.0] * robot.n)
    named = spec.stiffness if isinstance(spec.stiffness, dict) else names
    flexible = np.array([name in named for name in names])
    check_joint_names(list(named), names, f"{key}.stiffness")
    wrong = {"stiffness": stiffness <= 0.0, "rotor_inertia": rotor <= 0.0, "gear_ratio": ratio <= 0.0}
    for what, low in (wrong | {"damping": damping < 0.0}).items():
        if np.any(low & flexible):
            joint = names[int(np.argmax(low & flexible))]
            accepted = ">= 0" if what == "damping" else "> 0 of every joint that has a stiffness"
            value = getattr(spec, what)
            raise SpecError(f"cannot be that of {joint}", key=f"{key}.{what}", value=value, accepted=accepted)
    rows: Vector = np.column_stack([stiffness, damping, ratio**2 * rotor])
    rows[~flexible] = 0.0
    return rows
