"""From the actuators of a robot (checked when it was loaded) to the numbers the kernel allocates with."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from space_robot_description.kernel.linear import least_norm
from space_robot_description.robot import Robot
from space_robot_description.spec import ReactionWheels, Thrusters, expand
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import NANOSECONDS, Vector
from space_robot_sim.kernel.allocation import Capability


def capability(robot: Robot, period: int) -> Capability:
    """What the robot's actuators can do in one control period [ns].

    Raises:
        SpecError: a minimum pulse is longer than the period.
    """
    limit = np.full(6 + robot.n, np.inf)
    limit[6:] = robot.effort_limit
    acts, pulsed, minimum = np.zeros(6, dtype=np.int64), np.zeros(6, dtype=np.int64), np.zeros(6)
    axes, wheel_limit = np.zeros((3, 0)), np.zeros((0, 2))
    for part, key, actuator in (
        (slice(0, 3), "actuators.base_force", robot.actuators.base_force),
        (slice(3, 6), "actuators.base_torque", robot.actuators.base_torque),
    ):
        if isinstance(actuator, ReactionWheels):
            axes = _unit_axes(actuator)
            wheel_limit = np.tile([actuator.torque, actuator.momentum], (axes.shape[1], 1))
        elif actuator is not None:
            limit[part], acts[part] = actuator.limit, 1
        if isinstance(actuator, Thrusters):
            pulsed[part], minimum[part] = int(actuator.pwm), _minimum_pulse(actuator, period, key)
    share = least_norm(axes) if axes.size else np.zeros((0, 3))
    preserve = int(robot.actuators.saturation == "direction_preserving")
    undisturbed = 0, np.zeros(axes.shape[1]), np.zeros(6)
    return Capability(limit, acts, pulsed, minimum, axes, share, wheel_limit, preserve, *undisturbed)


def motor_numbers(robot: Robot, hidden: int = 0) -> Vector:
    """(n, 4) lag [s], viscous [N m s/rad], Coulomb [N m] and Coulomb velocity [rad/s] of every joint.

    Behind them come so many rows of joints without a motor.
    """
    joints = robot.actuators.joints
    columns = [
        expand(values, robot.joint_names, f"actuators.joints.{name}", [0.0] * robot.n)
        for name, values in (("lag", joints.lag), ("viscous", joints.viscous), ("coulomb", joints.coulomb))
    ]
    driven = np.column_stack([*columns, np.full(robot.n, joints.coulomb_velocity)])
    return np.vstack([driven, np.tile([0.0, 0.0, 0.0, 1.0], (hidden, 1))])


def initial_wheels(robot: Robot) -> Vector:
    """(k,) momenta of the wheels at the start of a run [N m s]; empty without wheels."""
    wheels = robot.actuators.base_torque
    if not isinstance(wheels, ReactionWheels):
        return np.zeros(0)
    return np.array(wheels.initial_momentum or (0.0,) * len(wheels.axes))


def _minimum_pulse(thrusters: Thrusters, period: int, key: str) -> float:
    if thrusters.minimum_pulse > period / NANOSECONDS:
        raise SpecError(
            "longer than the control period: no pulse could be fired",
            key=f"{key}.minimum_pulse",
            value=thrusters.minimum_pulse,
            accepted=f"up to {period / NANOSECONDS:g} s",
        )
    return thrusters.minimum_pulse


def _unit_axes(wheels: ReactionWheels) -> npt.NDArray[np.float64]:
    axes = np.array(wheels.axes, dtype=np.float64).T
    return np.ascontiguousarray(axes / np.linalg.norm(axes, axis=0))
