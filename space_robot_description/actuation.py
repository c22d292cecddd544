"""What pushes the robot, checked against the robot: a number per joint, wheels that span space, fitting thrusters."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from space_robot_description.robot import Robot
from space_robot_description.robot_spec import RobotSpec
from space_robot_description.spec import Actuators, IdealTorque, JointMotors, ReactionWheels, Thrusters, expand
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Vector


def check_actuators(spec: RobotSpec, joint_names: Sequence[str], urdf_effort: Sequence[float]) -> Actuators:
    """Actuators with one value per joint and unit wheel axes.

    Args:
        spec: the robot file.
        joint_names: the n joints in model order.
        urdf_effort: (n,) effort limits of the URDF, used for joints the file does not name; 0: it has none.

    Raises:
        SpecError: base mode and thrusters contradict each other, or a value does not fit.
    """
    actuators = spec.actuators
    if spec.base_mode == "free_flying" and actuators.base_force is None:
        raise SpecError(
            "free_flying needs thrusters", key="actuators.base_force", accepted="base_force, or free_floating"
        )
    if spec.base_mode == "free_floating" and actuators.base_force is not None:
        raise SpecError("free_floating has no thrusters", key="actuators.base_force", accepted="no base_force")
    if actuators.base_force is not None:
        _check_thrusters(actuators.base_force, "actuators.base_force")
    torque = actuators.base_torque
    if isinstance(torque, ReactionWheels):
        torque = _check_wheels(torque, "actuators.base_torque")
    elif isinstance(torque, Thrusters):
        _check_thrusters(torque, "actuators.base_torque")
    else:
        _check_limit(torque, "actuators.base_torque")
    joints = _check_motors(actuators.joints, joint_names, urdf_effort)
    return actuators.model_copy(update={"base_torque": torque, "joints": joints})


def torque_capacity(robot: Robot) -> tuple[Vector, Vector | None]:
    """Largest torque [N m] and, with wheels, momentum [N m s] about each body axis alone."""
    actuator = robot.actuators.base_torque
    if not isinstance(actuator, ReactionWheels):
        return np.array(actuator.limit), None
    axes = np.array(actuator.axes)
    axes = axes / np.linalg.norm(axes, axis=1, keepdims=True)
    # Column i of the pseudo-inverse: what each wheel does for one unit about body axis i; the busiest one fills first.
    unit_box = 1.0 / np.max(np.abs(np.linalg.pinv(axes.T)), axis=0)
    return actuator.torque * unit_box, actuator.momentum * unit_box


def _check_motors(motors: JointMotors, joint_names: Sequence[str], urdf_effort: Sequence[float]) -> JointMotors:
    update = {}
    for field in ("effort", "lag", "viscous", "coulomb", *(() if motors.brake is None else ("brake",))):
        key = f"actuators.joints.{field}"
        default = urdf_effort if field == "effort" else [0.0] * len(joint_names)
        values = expand(getattr(motors, field), joint_names, key, default).tolist()
        for name, value in zip(joint_names, values, strict=True):
            if value < 0.0:
                raise SpecError("is negative", key=f"{key}.{name}", value=value, accepted=">= 0")
            if field == "effort" and value == 0.0:
                raise SpecError(
                    "the joint has no effort limit",
                    key=f"{key}.{name}",
                    accepted="> 0, here or in the URDF's <limit>",
                )
        update[field] = tuple(values)
    return motors.model_copy(update=update)


def _check_wheels(wheels: ReactionWheels, key: str) -> ReactionWheels:
    axes = np.array(wheels.axes)
    lengths = np.linalg.norm(axes, axis=1)
    if not np.all(lengths > 1e-6):
        index = int(np.argmin(lengths))
        raise SpecError("wheel axis has no direction", key=f"{key}.axes.{index}", value=wheels.axes[index])
    # Axes already of length 1 keep their bits, so that resolving twice changes nothing.
    unit = np.where(np.abs(lengths - 1.0)[:, None] < 1e-15, axes, axes / lengths[:, None])
    if np.linalg.svd(unit, compute_uv=False)[2] < 1e-3:
        raise SpecError("wheel axes do not span three dimensions", key=f"{key}.axes", value=wheels.axes)
    if wheels.unloading is not None and not min(wheels.unloading) > 0.0:
        raise SpecError("is not positive", key=f"{key}.unloading", value=wheels.unloading, accepted="> 0 per axis")
    momentum = wheels.initial_momentum
    if momentum is not None:
        if len(momentum) != len(axes):
            key += ".initial_momentum"
            raise SpecError("one value per wheel is needed", key=key, value=momentum, accepted=f"{len(axes)} numbers")
        if max(map(abs, momentum)) > wheels.momentum:
            accepted = f"at most {wheels.momentum:g} N m s each"
            raise SpecError(
                "beyond the momentum limit", key=f"{key}.initial_momentum", value=momentum, accepted=accepted
            )
    return wheels.model_copy(update={"axes": tuple(tuple(axis) for axis in unit.tolist())})


def _check_thrusters(thrusters: Thrusters, key: str) -> None:
    _check_limit(thrusters, key)
    if thrusters.minimum_pulse > 0.0 and not thrusters.pwm:
        raise SpecError("only pulsed thrusters have one", key=f"{key}.minimum_pulse", accepted="pwm: true, or 0")


def _check_limit(actuator: IdealTorque | Thrusters, key: str) -> None:
    if min(actuator.limit) < 0.0:
        raise SpecError("limit is negative", key=f"{key}.limit", value=actuator.limit, accepted=">= 0 per axis")


def brake_torque(robot: Robot) -> Vector:
    """(n,) torque that the joints' brakes can hold [N m or N]; 0 where there is none."""
    brake = robot.actuators.joints.brake
    if brake is None:
        return np.zeros(robot.n)
    return expand(brake, robot.joint_names, "actuators.joints.brake", [0.0] * robot.n)


def command_limit(robot: Robot) -> Vector:
    """(6+n,) what the actuators can give along each channel [N, N m]; infinite where nothing acts."""
    limit, actuators = np.full(6 + robot.n, np.inf), robot.actuators
    if actuators.base_force is not None:
        limit[:3] = actuators.base_force.limit
    if isinstance(actuators.base_torque, ReactionWheels):
        axes = np.array(actuators.base_torque.axes, dtype=np.float64)
        unit = axes / np.linalg.norm(axes, axis=1, keepdims=True)
        limit[3:6] = actuators.base_torque.torque * np.abs(unit).sum(axis=0)
    else:
        limit[3:6] = actuators.base_torque.limit
    limit[6:] = robot.effort_limit
    return limit
