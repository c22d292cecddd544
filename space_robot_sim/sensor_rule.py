"""The channels of a sensor suite in numbers, and what of them cannot be."""

from __future__ import annotations

import numpy as np

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
