"""The channels of a sensor suite in numbers, and what of them cannot be."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from space_robot_description.robot import Robot
from space_robot_description.spec import ReactionWheels
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import NANOSECONDS, Vector
from space_robot_sim.kernel.sensor_rule import SensorRule
from space_robot_sim.spec import ChannelSpec, SensorSpec

MAX_DELAY = 10_000  # control periods; every one of them is kept
# The order in which they draw; readings are in the order of q, v and acceleration.
CHANNELS = (
    "position",
    "attitude",
    "linear_velocity",
    "angular_velocity",
    "joint_position",
    "joint_velocity",
    "acceleration",
)
READ = (
    "position",
    "attitude",
    "joint_position",
    "linear_velocity",
    "angular_velocity",
    "joint_velocity",
    "acceleration",
)


def sizes_of(joints: int) -> dict[str, int]:
    """How many errors each channel has; those of the attitude are 3 numbers on 4."""
    return dict.fromkeys(CHANNELS, 3) | {"joint_position": joints, "joint_velocity": joints}


def sensor_rule(spec: SensorSpec, joints: int, period: int) -> SensorRule:
    """The channels of a robot with that many joints at a control period [ns].

    Raises:
        SpecError: a delay that is too long or not a whole number of periods, or a vector of the wrong length.
    """
    sizes = sizes_of(joints)
    channels: list[ChannelSpec] = [getattr(spec, name) for name in READ]
    errors = [
        np.concatenate([_numbers(getattr(spec, name), field, sizes[name], name) for name in READ])
        for field in ("noise", "bias", "quantisation")
    ]
    readings = [sizes[name] + (name == "attitude") for name in READ]
    return SensorRule(
        np.cumsum([0, *readings], dtype=np.int64),
        np.array([channel.ideal for channel in channels], dtype=np.int64),
        np.array([_delay(getattr(spec, name), name, period) for name in READ], dtype=np.int64),
        *errors,
    )


class WheelRule(NamedTuple):
    """The channel of the wheels' momentum in numbers.

    Attributes:
        ideal: it shows the truth.
        delay: age of what it shows [periods].
        noise: (3,) standard deviation [N m s].
        bias: (3,) [N m s].
        quantum: (3,) step; 0: none [N m s].
    """

    ideal: bool
    delay: int
    noise: Vector
    bias: Vector
    quantum: Vector


def wheel_rule(spec: SensorSpec, period: int) -> WheelRule | None:
    """The channel of the wheels at a control period [ns]; None: it is not there.

    Raises:
        SpecError: see ``sensor_rule``.
    """
    channel, name = spec.wheel_momentum, "wheel_momentum"
    if channel is None:
        return None
    numbers = (_numbers(channel, field, 3, name) for field in ("noise", "bias", "quantisation"))
    return WheelRule(channel.ideal, _delay(channel, name, period), *numbers)


def check_sensors(spec: SensorSpec, robot: Robot, period: int) -> None:
    """Refuse a suite that a robot cannot have at a control period [ns].

    Raises:
        SpecError: see ``sensor_rule`` and ``check_wheels``.
    """
    check_wheels(spec, robot)
    sensor_rule(spec, robot.n, period)
    wheel_rule(spec, period)


def check_wheels(spec: SensorSpec, robot: Robot) -> None:
    """Refuse readings of wheels that a robot does not have.

    Raises:
        SpecError: the momentum of its wheels is to be measured, and it has none.
    """
    if spec.wheel_momentum is not None and not isinstance(robot.actuators.base_torque, ReactionWheels):
        accepted = "a robot whose base_torque is reaction_wheels, or null"
        raise SpecError("the robot has no wheels", key="plant.sensors.wheel_momentum", accepted=accepted)


def _delay(spec: ChannelSpec, name: str, period: int) -> int:
    """Age of what a channel shows [periods]."""
    key = f"plant.sensors.{name}.delay"
    periods, rest = divmod(round(spec.delay * NANOSECONDS), period)
    if rest:
        accepted = f"multiples of {period / NANOSECONDS:g} s"
        raise SpecError("not a multiple of the control period", key=key, value=spec.delay, accepted=accepted)
    if periods > MAX_DELAY:
        accepted = f"at most {MAX_DELAY} control periods, {MAX_DELAY * period / NANOSECONDS:g} s"
        raise SpecError("too old a reading", key=key, value=spec.delay, accepted=accepted)
    return periods


def _numbers(spec: ChannelSpec, field: str, size: int, name: str) -> Vector:
    value, key = getattr(spec, field), f"plant.sensors.{name}.{field}"
    if isinstance(value, tuple) and len(value) != size:
        raise SpecError("wrong number of values", key=key, value=len(value), accepted=f"one number, or {size}")
    return np.full(size, value, dtype=np.float64) if not isinstance(value, tuple) else np.array(value, dtype=np.float64)
