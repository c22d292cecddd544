"""Where a run starts, and what every plant needs to know of the run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.kernel.products import norm as length
from space_robot_msgs_py.vectors import Vector, vector
from space_robot_sim.spec import Hold, MonitorSpec


@dataclass(frozen=True, eq=False, slots=True)
class InitialState:
    """Where a run starts.

    Attributes:
        q: (7+n,) configuration [m, -, rad], as in RobotState; its quaternion is made unit.
        v: (6+n,) velocity [m/s, rad/s].
    """

    q: Vector
    v: Vector

    def __post_init__(self) -> None:
        q = np.array(vector(self.q, None, "initial.q"))
        norm = length(q[3:7])
        if abs(norm - 1.0) > 1e-6:
            raise SpecError("the quaternion is not unit", key="initial.q", value=norm, accepted="norm 1")
        q[3:7] /= norm
        object.__setattr__(self, "q", vector(q, None, "initial.q"))
        object.__setattr__(self, "v", vector(self.v, q.size - 1, "initial.v"))


@dataclass(frozen=True, eq=False, slots=True)
class RunConditions:
    """What a plant needs to know of a run besides its own specification.

    Attributes:
        control_period: [ns].
        initial: where the run starts.
        seed: of everything random in the plant.
        delay_periods: 1: the command that answers state k acts from state k+1 on, and nothing does before.
        hold: what acts in place of a missing command: nothing, the last one, or the last one for some periods.
        monitor: what is checked of commands; None: nothing.
    """

    control_period: int
    initial: InitialState
    seed: int = 0
    delay_periods: Literal[0, 1] = 0
    hold: Hold = "zero"
    monitor: MonitorSpec | None = None
