"""Faults of the sensors: what is done to the reading of one channel."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from math import sqrt
from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
import numpy.typing as npt
from pydantic import Field, PositiveFloat, model_validator

from space_robot_description.rotations import exp, from_rpy, log, product, rotate_inverse
from space_robot_description.spec import Three
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.products import dot, norm
from space_robot_sim.faults.base import Fault, FaultSite
from space_robot_sim.sensor_rule import MAX_DELAY

Channel = Literal[
    "position",
    "attitude",
    "linear_velocity",
    "angular_velocity",
    "joint_position",
    "joint_velocity",
    "acceleration",
    "wheel_momentum",
]
Probability = Annotated[float, Field(gt=0.0, le=1.0)]
Numbers = float | tuple[float, ...]
ATTITUDE = "attitude"


@dataclass(slots=True)
class Reading:
    """The reading of a channel at one tick.

    Attributes:
        value: what is read, earlier faults included.
        last: what was reported at the tick before; at the first tick what is read.
        noise: standard deviation of the channel's own noise.
        elapsed: [s] since the onset.
        rng: of this fault at this tick.
        past: (k,) readings of the last ticks, this one last; longer than one only where the fault asks for it.
    """

    value: Vector
    last: Vector
    noise: Numbers
    elapsed: float
    rng: np.random.Generator
    past: deque[Vector]


class SensorFault(Fault):
    """What all of them have: a channel. The errors of an attitude are small rotations of the body frame [rad]."""

    group: ClassVar[str] = "sensors"
    channel: Channel = Field(description="as in `plant.sensors`")

    @property
    def place(self) -> str:
        """The channel."""
        return self.channel

    @property
    def size(self) -> int:
        """Numbers of an error; 0: one per joint."""
        return 0 if self.channel.startswith("joint") else 3

    def check(self, site: FaultSite, key: str) -> None:
        """Refuse a channel that is not measured."""
        if getattr(site.sensors, self.channel) is None:
            accepted = f"plant.sensors.{self.channel} in the experiment, or another channel"
            raise SpecError("is not measured", key=f"{key}.channel", value=self.channel, accepted=accepted)

    def periods(self, period: float) -> int:
        """How many ticks back it looks, at a control period [s]."""
        return 0

    def read(self, now: Reading) -> Vector:
        """What is reported instead of ``now.value``."""
        raise NotImplementedError

    def shifted(self, value: Vector, error: Vector) -> Vector:
        """A reading with an error on it."""
        if self.channel == ATTITUDE:
            return np.array(product(value, exp(error)))
        return value + error

    def errors(self, value: Vector) -> int:
        """How many numbers an error of this reading has."""
        return 3 if self.channel == ATTITUDE else value.size

    def _check_size(self, numbers: Any, site: FaultSite, key: str) -> None:
        size = self.size or site.robot.n
        if isinstance(numbers, tuple) and len(numbers) != size:
            accepted = f"one number, or {size}"
            raise SpecError("wrong number of values", key=key, value=len(numbers), accepted=accepted)


class SensorBias(SensorFault):
    """The reading is off by a constant."""

    kind: Literal["sensor_bias"] = "sensor_bias"
    bias: Numbers = Field(description="one number, or one per component, in the channel's unit")

    def check(self, site: FaultSite, key: str) -> None:
        """Refuse a vector of another length."""
        super().check(site, key)
        self._check_size(self.bias, site, f"{key}.bias")

    def read(self, now: Reading) -> Vector:
        """Off by the bias."""
        return self.shifted(now.value, _full(self.bias, self.errors(now.value)))


class SensorDrift(SensorFault):
    """The reading is off by more and more."""

    kind: Literal["sensor_drift"] = "sensor_drift"
    rate: Numbers = Field(description="one number, or one per component, in the channel's unit per second")

    def check(self, site: FaultSite, key: str) -> None:
        """Refuse a vector of another length."""
        super().check(site, key)
        self._check_size(self.rate, site, f"{key}.rate")

    def read(self, now: Reading) -> Vector:
        """Off by the rate times the time since the onset."""
        return self.shifted(now.value, now.elapsed * _full(self.rate, self.errors(now.value)))


class SensorNoise(SensorFault):
    """White noise beside the channel's own: of a standard deviation, or so that the whole is a multiple of its own."""

    kind: Literal["sensor_noise"] = "sensor_noise"
    sigma: PositiveFloat | None = Field(default=None, description="standard deviation, in the channel's unit")
    factor: Annotated[float, Field(ge=1.0)] | None = Field(
        default=None, description="noise with the fault over the channel's own [-]; instead of sigma"
    )

    @model_validator(mode="after")
    def _one(self) -> Self:
        if (self.sigma is None) == (self.factor is None):
            raise ValueError("say sigma or factor, and not both")
        return self

    def check(self, site: FaultSite, key: str) -> None:
        """Refuse a multiple of nothing."""
        super().check(site, key)
        if self.factor is not None and not np.any(getattr(site.sensors, self.channel).noise):
            accepted = f"sigma, or plant.sensors.{self.channel}.noise"
            raise SpecError("the channel has no noise", key=f"{key}.factor", value=self.factor, accepted=accepted)

    def read(self, now: Reading) -> Vector:
        """One draw of noise more."""
        size = self.errors(now.value)
        own = _full(now.noise, size)
        sigma = (
            own * sqrt(self.factor * self.factor - 1.0) if self.factor is not None else _full(self.sigma or 0.0, size)
        )
        return self.shifted(now.value, sigma * now.rng.standard_normal(size))


class SensorScale(SensorFault):
    """The reading is a multiple of what it should be; of an attitude its rotation vector, the short way."""

    kind: Literal["sensor_scale"] = "sensor_scale"
    factor: float = Field(description="[-]")

    def read(self, now: Reading) -> Vector:
        """Scaled."""
        if self.channel == ATTITUDE:
            return _near(np.array(exp([self.factor * part for part in log(now.value)])), now.value)
        return self.factor * now.value


class SensorFrozen(SensorFault):
    """The reading stays what it was at the tick before the onset."""

    kind: Literal["sensor_frozen"] = "sensor_frozen"

    def read(self, now: Reading) -> Vector:
        """What was reported last."""
        return now.last


class SensorDropout(SensorFault):
    """There is no new reading: the last one is repeated."""

    kind: Literal["sensor_dropout"] = "sensor_dropout"
    probability: Probability = Field(default=1.0, description="of each reading [-]")

    def read(self, now: Reading) -> Vector:
        """What was reported last, or what is read."""
        return now.last if now.rng.random() < self.probability else now.value


class SensorNan(SensorDropout):
    """The reading is not a number, which passes no boundary: it is refused there, and the last one is repeated."""

    kind: Literal["sensor_nan"] = "sensor_nan"  # type: ignore[assignment]


class SensorOutliers(SensorFault):
    """Some readings are wrong by a vector of random direction."""

    kind: Literal["sensor_outliers"] = "sensor_outliers"
    probability: Probability = Field(description="of each reading [-]")
    length: PositiveFloat = Field(description="of the error, in the channel's unit")

    def read(self, now: Reading) -> Vector:
        """Wrong, or not."""
        direction = now.rng.standard_normal(self.errors(now.value))
        if now.rng.random() >= self.probability:
            return now.value
        return self.shifted(now.value, self.length * direction / norm(direction))


class SensorDelay(SensorFault):
    """The reading is older than it should be."""

    kind: Literal["sensor_delay"] = "sensor_delay"
    delay: PositiveFloat = Field(description="beside the channel's own [s], whole control periods")

    def periods(self, period: float) -> int:
        """The delay."""
        return round(self.delay / period)

    def check(self, site: FaultSite, key: str) -> None:
        """Refuse parts of a control period, and more than is kept."""
        super().check(site, key)
        periods = self.periods(site.period)
        if not 1 <= periods <= MAX_DELAY or abs(periods * site.period - self.delay) > 1e-9 * self.delay:
            accepted = f"multiples of {site.period:g} s, at most {MAX_DELAY} of them"
            raise SpecError("is no such delay", key=f"{key}.delay", value=self.delay, accepted=accepted)

    def read(self, now: Reading) -> Vector:
        """An older reading; the first one where none is old enough."""
        return now.past[0]


class SensorSignFlip(SensorFault):
    """The quaternion comes with the other sign, which is the same attitude: a law must not mind."""

    kind: Literal["sensor_sign_flip"] = "sensor_sign_flip"
    channel: Literal["attitude"] = Field(default="attitude", description="only this one")
    probability: Probability = Field(default=1.0, description="of each reading [-]")

    def read(self, now: Reading) -> Vector:
        """The same attitude."""
        return -now.value if now.rng.random() < self.probability else now.value


class SensorFrame(SensorFault):
    """The sensor is mounted in another frame than is believed: its readings are those of a turned body."""

    kind: Literal["sensor_frame"] = "sensor_frame"
    rpy_deg: Three = Field(description="roll, pitch, yaw of the mounting error (R = Rz Ry Rx) [deg]")

    def check(self, site: FaultSite, key: str) -> None:
        """Refuse a channel that is no vector of space."""
        super().check(site, key)
        if not self.size:
            accepted = "attitude, position, linear_velocity, angular_velocity, acceleration, wheel_momentum"
            raise SpecError("has no frame", key=f"{key}.channel", value=self.channel, accepted=accepted)

    def read(self, now: Reading) -> Vector:
        """Turned: R(q) R for an attitude, R^T r for a vector."""
        turn = from_rpy(np.radians(self.rpy_deg).tolist())
        if self.channel == ATTITUDE:
            return _near(np.array(product(now.value, turn)), now.value)
        return np.array(rotate_inverse(turn, now.value))


def _full(value: Numbers, size: int) -> Vector:
    out: npt.NDArray[np.float64] = np.broadcast_to(np.asarray(value, dtype=np.float64), (size,))
    return out


def _near(q: Vector, other: Vector) -> Vector:
    """Of q and -q, which are one attitude, the one on the side of another."""
    return q if dot(q, other) >= 0.0 else -q
