"""What sensors make of the truth, compiled: delay, then bias and noise, then quantisation, channel by channel."""

from __future__ import annotations

from math import sqrt

import numpy as np

from space_robot_description.kernel.jit import inner, kernel
from space_robot_description.kernel.quaternion import Quat, log
from space_robot_description.kernel.spatial import Vec
from space_robot_msgs_py.interfaces import Vector
from space_robot_msgs_py.kernel.elementary import sincos
from space_robot_sim.kernel.sensor_rule import SensorRule


@kernel
def read_sensors(rule: SensorRule, history: Vector, tick: int, draws: Vector, out: Vector) -> None:
    """Write the readings (16+2n,) of a tick: q, v, acceleration.

    Args:
        rule: the channels.
        history: (K, 16+2n) the truth of tick k in row k modulo K.
        tick: of the reading.
        draws: (15+2n,) standard normal numbers.
        out: written.
    """
    for channel in range(rule.ideal.shape[0]):
        begin, end = rule.first[channel], rule.first[channel + 1]
        # Before the first delayed reading is due the sensor shows the initial value.
        truth = history[max(0, tick - rule.delay[channel]) % history.shape[0]]
        if rule.ideal[channel]:
            for i in range(begin, end):
                out[i] = truth[i]
        elif channel == 1:
            _turn(rule, truth, draws, out)
        else:
            for i in range(begin, end):
                k = i - 1 if begin > 3 else i
                out[i] = _rounded(truth[i] + (rule.bias[k] + rule.noise[k] * draws[k]), rule.quantum[k])


@inner
def _rounded(value: float, quantum: float) -> float:
    return float(np.rint(value / quantum)) * quantum if quantum > 0.0 else value


@inner
def _turn(rule: SensorRule, truth: Vector, draws: Vector, out: Vector) -> None:
    """Turn by a rotation vector in the body frame, and round the rotation vector of the whole attitude."""
    actual = (truth[3], truth[4], truth[5], truth[6])
    read = _product(
        actual,
        _exp(
            (
                rule.bias[3] + rule.noise[3] * draws[3],
                rule.bias[4] + rule.noise[4] * draws[4],
                rule.bias[5] + rule.noise[5] * draws[5],
            )
        ),
    )
    if rule.quantum[3] > 0.0 or rule.quantum[4] > 0.0 or rule.quantum[5] > 0.0:
        sign = -1.0 if read[3] < 0.0 else 1.0
        a, b, c = log((sign * read[0], sign * read[1], sign * read[2], sign * read[3]))
        read = _exp((_rounded(a, rule.quantum[3]), _rounded(b, rule.quantum[4]), _rounded(c, rule.quantum[5])))
    length = sqrt(read[0] * read[0] + read[1] * read[1] + read[2] * read[2] + read[3] * read[3])
    along = read[0] * actual[0] + read[1] * actual[1] + read[2] * actual[2] + read[3] * actual[3]
    # q and -q are one attitude: keep to the side of the truth.
    scale = 1.0 / length if along >= 0.0 else -1.0 / length
    out[3], out[4], out[5], out[6] = scale * read[0], scale * read[1], scale * read[2], scale * read[3]


@inner
def _exp(a: Vec) -> Quat:
    """The unit quaternion of a rotation vector."""
    angle = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])
    sine, cosine = sincos(0.5 * angle)
    scale = sine / angle if angle > 0.0 else 0.5
    return scale * a[0], scale * a[1], scale * a[2], cosine


@inner
def _product(a: Quat, b: Quat) -> Quat:
    """The rotation b followed by a."""
    return (
        a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1],
        a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
        a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3],
        a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2],
    )
