"""What the flight software sees of the truth: noise, bias, quantisation and delay per channel."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from space_robot_description.robot import Robot
from space_robot_description.spec import ReactionWheels
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import NANOSECONDS, RobotState, Vector
from space_robot_sim.spec import ChannelSpec, SensorSpec

MAX_DELAY = 10_000  # control periods; every one of them is kept


class Sensors:
    """The suite of one robot; the truth it measures has the momentum of the wheels where the suite has that channel.

    Every channel draws from a generator of its own, so noise on one channel never changes another.

    Args:
        spec: what each channel does to the truth.
        joints: number of joints.
        period: control period [ns].
        seed: of all generators.

    Raises:
        SpecError: a delay that is too long or not a whole number of periods, or a vector of the wrong length.
    """

    def __init__(self, spec: SensorSpec, joints: int, period: int, seed: int) -> None:
        self._spec, self._period, self._seed = spec, period, seed
        # (channel, its size or 0 for the attitude, whose errors are 3 numbers on 4).
        self._sizes = {
            "position": 3,
            "attitude": 3,
            "linear_velocity": 3,
            "angular_velocity": 3,
            "joint_position": joints,
            "joint_velocity": joints,
            "acceleration": 3,
        }
        # Last: the generators of the others stay what they are without it.
        if spec.wheel_momentum is not None:
            self._sizes["wheel_momentum"] = 3
        self.ideal = all(getattr(spec, name).ideal for name in self._sizes)
        self.reset()

    def reset(self) -> None:
        """Forget delayed readings and restart every generator."""
        children = np.random.SeedSequence(self._seed).spawn(len(self._sizes))
        self._channels = {
            name: _channel(name, getattr(self._spec, name), size, self._period, np.random.default_rng(child))
            for (name, size), child in zip(self._sizes.items(), children, strict=True)
        }

    def measure(self, truth: RobotState) -> RobotState:
        """What is read of the truth at one stamp; call once per stamp, in order."""
        if self.ideal:
            return truth
        read = {name: channel.read for name, channel in self._channels.items()}
        q, v = truth.q, truth.v
        configuration = (
            read["position"](q[:3]),
            read["attitude"](q[3:7]),
            read["joint_position"](q[7:]),
        )
        velocity = (
            read["linear_velocity"](v[:3]),
            read["angular_velocity"](v[3:6]),
            read["joint_velocity"](v[6:]),
        )
        acceleration, wheels = read["acceleration"](truth.base_acceleration), truth.wheel_momentum
        if wheels is not None:
            wheels = read["wheel_momentum"](wheels)
        return RobotState(
            truth.stamp, np.concatenate(configuration), np.concatenate(velocity), truth.effort, acceleration, wheels
        )


def check_wheels(spec: SensorSpec, robot: Robot) -> None:
    """Refuse readings of wheels that a robot does not have.

    Raises:
        SpecError: the momentum of its wheels is to be measured, and it has none.
    """
    if spec.wheel_momentum is not None and not isinstance(robot.actuators.base_torque, ReactionWheels):
        accepted = "a robot whose base_torque is reaction_wheels, or null"
        raise SpecError("the robot has no wheels", key="plant.sensors.wheel_momentum", accepted=accepted)


@dataclass(slots=True)
class _Channel:
    """Delay, then bias and noise, then quantisation of one vector."""

    noise: Vector
    bias: Vector
    quantum: Vector
    late: deque[Vector]
    rng: np.random.Generator
    spoil: Callable[[Vector, Vector, Vector], Vector]
    ideal: bool

    def read(self, truth: Vector) -> Vector:
        if self.ideal:
            return truth
        # Before the first delayed reading is due the sensor shows the initial value.
        while len(self.late) < (self.late.maxlen or 1):
            self.late.append(truth)
        self.late.append(truth)
        error = self.bias + self.noise * self.rng.standard_normal(self.bias.size)
        return self.spoil(self.late[0], error, self.quantum)


def _channel(name: str, spec: ChannelSpec, size: int, period: int, rng: np.random.Generator) -> _Channel:
    key = f"plant.sensors.{name}"
    periods, rest = divmod(round(spec.delay * NANOSECONDS), period)
    if rest:
        raise SpecError(
            "not a multiple of the control period",
            key=f"{key}.delay",
            value=spec.delay,
            accepted=f"multiples of {period / NANOSECONDS:g} s",
        )
    if periods > MAX_DELAY:
        raise SpecError(
            "too old a reading",
            key=f"{key}.delay",
            value=spec.delay,
            accepted=f"at most {MAX_DELAY} control periods, {MAX_DELAY * period / NANOSECONDS:g} s",
        )
    noise, bias, quantum = (
        _numbers(value, size, f"{key}.{field}")
        for field, value in (("noise", spec.noise), ("bias", spec.bias), ("quantisation", spec.quantisation))
    )
    spoil = _spoil_attitude if name == "attitude" else _spoil_vector
    return _Channel(noise, bias, quantum, deque(maxlen=periods + 1), rng, spoil, spec.ideal)


def _numbers(value: float | tuple[float, ...], size: int, key: str) -> Vector:
    if isinstance(value, tuple) and len(value) != size:
        raise SpecError("wrong number of values", key=key, value=len(value), accepted=f"one number, or {size}")
    return np.full(size, value, dtype=np.float64) if not isinstance(value, tuple) else np.array(value)


def _round_to(value: Vector, quantum: Vector) -> Vector:
    step = np.where(quantum > 0.0, quantum, 1.0)
    return np.where(quantum > 0.0, np.round(value / step) * step, value)


def _spoil_vector(truth: Vector, error: Vector, quantum: Vector) -> Vector:
    return _round_to(truth + error, quantum)


def _spoil_attitude(truth: Vector, error: Vector, quantum: Vector) -> Vector:
    """Turn by a rotation vector in the body frame, and round the rotation vector of the whole attitude."""
    read = pin.Quaternion(np.array(truth)) * pin.Quaternion(pin.exp3(error))
    if quantum.any():
        read = pin.Quaternion(pin.exp3(_round_to(pin.log3(read.matrix()), quantum)))
    read.normalize()
    out: Vector = read.coeffs().copy()
    # q and -q are one attitude: keep to the side of the truth.
    return out if out @ truth >= 0.0 else -out
