"""Park: the base comes to rest, the arm goes to a stowed posture on a path within bounds, and stays there."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from pydantic import Field, PositiveFloat

from space_robot_control.laws.compiled import CompiledLaw, Layout
from space_robot_control.laws.gain_range import GainRange, GainRanges
from space_robot_control.laws.park.kernel.answer import ParkContext, ParkRule, answer, keep
from space_robot_control.laws.rates_to_zero import RatesToZero
from space_robot_control.tracking import ERROR_FIELDS
from space_robot_description.kernel.context import context_of
from space_robot_description.spec import PerJoint, expand
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.interfaces import Vector


class Park(RatesToZero):
    """u = s H [-w' v_b, a + w' (r - q') + w'^2/4 (p - q)], w' = w / (1 + w T): base to rest, joints along p, r.

    H is the nominal inertia at the state, with the translation eliminated where no force acts on the base; s in (0, 1]
    scales the command until it fits the actuators. The path starts at the measured joints and rates and ends at the
    posture q_p. With e = q_p - p its next rate is sgn(e) min(v, A T (sqrt(1/4 + 2 |e| / (A T^2)) - 1/2), |e| / T), from
    which it can stop at the posture in whole periods, but at most A T from the rate before; a is the change over T.
    Where the actuators cannot give the command (s < 1) the path starts again at the state that comes next.

    The reference is not followed; errors to it are telemetry.

    Args:
        robot: the NOMINAL robot.
        control_period: T [s].
        gains: rate, speed, acceleration, posture.

    Raises:
        SpecError: the posture does not fit the robot, or is beyond a joint limit.

    The equations on one screen: ``reference.py``.

    Deviations from the paper: there is none; this is a law a robot falls back to.
    """

    class Gains(RatesToZero.Gains):
        """Gains of park."""

        speed: PositiveFloat = Field(default=0.05, description="v, largest joint rate on the path [rad/s or m/s]")
        acceleration: PositiveFloat = Field(
            default=0.01, description="A, largest joint acceleration on the path [rad/s2 or m/s2]"
        )
        posture: PerJoint | None = Field(
            default=None, description="q_p, where the joints are parked; null: the robot's home [rad or m]"
        )

    name = "park"
    gain_ranges: ClassVar[GainRanges] = {"rate": GainRange(0.02, 5.0), "speed": GainRange(0.005, 0.5)}
    telemetry_fields = ERROR_FIELDS | {
        "path": "p [rad or m]",
        "path_rate": "r [rad/s or m/s]",
        "posture_error": "q_p - q [rad or m]",
        "scale": "s, less than 1 where the actuators cannot give the command [-]",
    }
    gains: Gains

    def form(self) -> CompiledLaw:
        """See ``kernel/answer.py``."""
        gains, period = self.gains, self.control_period
        posture = np.array(self._checked_posture(), dtype=np.float64)
        rule = ParkRule(period, gains.speed, gains.acceleration * period, posture)
        context = ParkContext(rule, self.known, self.room, self.begun, np.zeros((3, self.n)))
        layout = Layout.of({**self.errors, "path": self.n, "path_rate": self.n, "posture_error": self.n, "scale": 1})
        return CompiledLaw(answer, context_of(context, keep), layout)

    def _checked_posture(self) -> Vector:
        robot, key = self.robot, "controller.gains.posture"
        if self.gains.posture is None:
            return robot.home
        posture = expand(self.gains.posture, robot.joint_names, key, robot.home.tolist())
        for name, value, lower, upper in zip(
            robot.joint_names, posture.tolist(), robot.joint_lower, robot.joint_upper, strict=True
        ):
            if not lower <= value <= upper:
                accepted = f"{lower:g} to {upper:g}"
                raise SpecError("beyond the joint's limits", key=f"{key}.{name}", value=value, accepted=accepted)
        return posture
