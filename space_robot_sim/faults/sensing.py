"""The stage between sensors and flight software: readings, with the faults of that tick on them."""

from __future__ import annotations

from collections import deque

import numpy as np

from space_robot_msgs_py.interfaces import NANOSECONDS, RobotState, Vector
from space_robot_sim.faults.plan import FaultPlan
from space_robot_sim.faults.sensors import Reading, SensorFault
from space_robot_sim.spec import SensorSpec


class SensorStage:
    """Changes readings by the faults that act.

    Args:
        plan: of the run.
        sensors: the channels without faults.
    """

    def __init__(self, plan: FaultPlan, sensors: SensorSpec) -> None:
        self._plan, self._sensors = plan, sensors
        self._planned = plan.of(SensorFault)
        self.reset()

    def reset(self) -> None:
        """Forget all readings."""
        period = self._plan.period / NANOSECONDS
        self._last: dict[str, Vector] = {}
        self._past: dict[int, deque[Vector]] = {}
        for one in self._planned:
            assert isinstance(one.fault, SensorFault)
            self._past[one.index] = deque(maxlen=1 + one.fault.periods(period))

    def read(self, tick: int, state: RobotState) -> RobotState:
        """What is reported at a tick in place of this state; call once per tick, in order."""
        if not self._planned:
            return state
        channels = _channels(state)
        for one in self._planned:
            fault = one.fault
            assert isinstance(fault, SensorFault)
            value, past = channels[fault.channel], self._past[one.index]
            past.append(value)
            if not one.acts(tick):
                continue
            noise, last = getattr(self._sensors, fault.channel).noise, self._last.get(fault.channel, value)
            elapsed = (tick - one.first) * self._plan.period / NANOSECONDS
            channels[fault.channel] = fault.read(Reading(value, last, noise, elapsed, self._plan.rng(one, tick), past))
        self._last = channels
        return _state(state, channels)


def _channels(state: RobotState) -> dict[str, Vector]:
    q, v = state.q, state.v
    channels = {
        "position": q[:3],
        "attitude": q[3:7],
        "joint_position": q[7:],
        "linear_velocity": v[:3],
        "angular_velocity": v[3:6],
        "joint_velocity": v[6:],
        "acceleration": state.base_acceleration,
    }
    return channels if state.wheel_momentum is None else channels | {"wheel_momentum": state.wheel_momentum}


def _state(state: RobotState, channels: dict[str, Vector]) -> RobotState:
    q = np.concatenate([channels[name] for name in ("position", "attitude", "joint_position")])
    v = np.concatenate([channels[name] for name in ("linear_velocity", "angular_velocity", "joint_velocity")])
    return RobotState(state.stamp, q, v, state.effort, channels["acceleration"], channels.get("wheel_momentum"))
