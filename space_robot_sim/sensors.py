"""What the flight software sees of the truth: noise, bias, quantisation and delay per channel."""

from __future__ import annotations

from collections import deque
from dataclasses import replace

import numpy as np

from space_robot_msgs_py.interfaces import RobotState, Vector
from space_robot_sim.sensor_rule import CHANNELS, READ, WheelRule, sensor_rule, sizes_of, wheel_rule
from space_robot_sim.spec import SensorSpec


class Sensors:
    """The suite of one robot; the truth it measures has the momentum of the wheels where the suite has that channel.

    Every channel draws from a generator of its own, so noise on one channel never changes another.

    Args:
        spec: what each channel does to the truth.
        joints: number of joints.
        period: control period [ns].
        seed: of all generators.

    Attributes:
        ideal: every channel but that of the wheels shows the truth.
        rule: all channels in numbers, for kernels.

    Raises:
        SpecError: a delay that is too long or not a whole number of periods, or a vector of the wrong length.
    """

    def __init__(self, spec: SensorSpec, joints: int, period: int, seed: int) -> None:
        self._seed = seed
        self._sizes = sizes_of(joints)
        self.ideal = all(getattr(spec, name).ideal for name in CHANNELS)
        self.rule = sensor_rule(spec, joints, period)
        self._wheel_rule = wheel_rule(spec, period)
        self._history = np.zeros((int(self.rule.delay.max()) + 1, 16 + 2 * joints))
        self._split = 7 + joints, 13 + 2 * joints
        if not self.ideal:
            # Only here: ideal sensors do not load a compiler.
            from space_robot_description.kernel.jit import bound
            from space_robot_sim.kernel.sensors import read_sensors

            example = np.zeros(15 + 2 * joints), np.zeros(16 + 2 * joints)
            self._read = bound(read_sensors, self.rule, self._history, 0, *example)
        self.reset()

    def reset(self) -> None:
        """Forget delayed readings and restart every generator."""
        # Generators take longer to make than all else here, and ideal channels have no use for them.
        ideal = dict(zip(READ, self.rule.ideal, strict=True))
        self._rng = {name: self._generator(place) for place, name in enumerate(CHANNELS) if not ideal[name]}
        self._tick = 0
        self._wheels: WheelReading | None = None
        if self._wheel_rule is not None:
            # After the others, whose generators stay what they are without it.
            self._wheels = WheelReading(self._wheel_rule, self._generator(len(CHANNELS)))

    def _generator(self, place: int) -> np.random.Generator:
        """The generator of a channel, which no other channel changes."""
        return np.random.default_rng(np.random.SeedSequence(self._seed, spawn_key=(place,)))

    def draws(self, ticks: int) -> Vector:
        """The random numbers (ticks, 15+2n) of so many further readings; as many at once as one by one."""
        parts = []
        for channel, name in enumerate(READ):
            shape = (ticks, self._sizes[name])
            parts.append(np.zeros(shape) if self.rule.ideal[channel] else self._rng[name].standard_normal(shape))
        return np.concatenate(parts, axis=1)

    def measure(self, truth: RobotState) -> RobotState:
        """What is read of the truth at one stamp; call once per stamp, in order."""
        wheels = truth.wheel_momentum
        if wheels is not None and self._wheels is not None:
            wheels = self._wheels.read(wheels)
        if self.ideal:
            return truth if wheels is truth.wheel_momentum else replace(truth, wheel_momentum=wheels)
        self._history[self._tick % len(self._history)] = np.concatenate([truth.q, truth.v, truth.base_acceleration])
        read = np.empty(self._history.shape[1])
        self._read(self.rule, self._history, self._tick, self.draws(1)[0], read)
        self._tick += 1
        a, b = self._split
        return RobotState(truth.stamp, read[:a], read[a:b], truth.effort, read[b:], wheels)


class WheelReading:
    """What is read of the wheels' momentum: delay, then bias and noise, then quantisation.

    Args:
        rule: of the channel.
        generator: of its noise.
    """

    def __init__(self, rule: WheelRule, generator: np.random.Generator) -> None:
        self._rule, self._generator = rule, generator
        self._late: deque[Vector] = deque(maxlen=rule.delay + 1)

    def read(self, truth: Vector) -> Vector:
        """The reading (3,) at a stamp of what is true there (3,) [N m s]."""
        rule = self._rule
        if rule.ideal:
            return truth
        # Before the first delayed reading is due the sensor shows the initial value.
        while len(self._late) < rule.delay:
            self._late.append(truth)
        self._late.append(truth)
        read = self._late[0] + (rule.bias + rule.noise * self._generator.standard_normal(3))
        step = np.where(rule.quantum > 0.0, rule.quantum, 1.0)
        return np.where(rule.quantum > 0.0, np.round(read / step) * step, read)
