"""Tracking errors of a free-flying robot, in the actual body frame."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from space_robot_control.kernel.tracking import track
from space_robot_msgs_py.interfaces import Reference, RobotState, Vector

ERROR_FIELDS = {
    "position_error": "R^T (p_d - p), body frame [m]",
    "attitude_error": "log R_e, rotation vector, body frame [rad]",
    "joint_error": "q_d - q [rad or m]",
    "twist_error": "R_e v_d - v and R_e w_d - w, body frame [m/s, rad/s]",
    "joint_rate_error": "q_d' - q' [rad/s or m/s]",
}


@dataclass(frozen=True, eq=False, slots=True)
class TrackingErrors:
    """Desired minus actual in task coordinates; every base vector is in the ACTUAL body frame.

    With R, R_d body to inertial, R_e = R^T R_d, and desired twist (v_d, w_d) in the desired body frame:

    Attributes:
        configuration: (6+n,) [R^T (p_d - p), log(R_e) the short way, q_d - q] [m, rad, rad].
        velocity: (6+n,) [R_e v_d - v, R_e w_d - w, q_d' - q'] [m/s, rad/s, rad/s].
        feedforward: (6+n,) the derivative of v that keeps the velocity error as it is (see below) [m/s2, rad/s2].
        quaternion: (4,) of R_e, w >= 0.

    Derivation of the feed-forward, with S(w) x = w x x and R' = R S(w):

    Translation: the inertial position error E = p_d - p has E' = R (R_e v_d - v) and
    E'' = R [R_e (v_d' + w_d x v_d) - (v' + w x v)]. E'' = 0 for v' = R_e (v_d' + w_d x v_d) - w x v.

    Rotation: e_w = R_e w_d - w and R_e' = S(e_w) R_e, so e_w' = e_w x R_e w_d + R_e w_d' - w' and, since
    R_e w_d x R_e w_d = 0, e_w' = 0 for w' = R_e w_d' - w x R_e w_d.

    With v' = feedforward + b, translation obeys E'' = -R b, rotation e_w' = -b, joints e'' = -b. For a rotation about
    one axis, and to first order for any small one, log(R_e)' = e_w.
    """

    configuration: Vector
    velocity: Vector
    feedforward: Vector
    quaternion: Vector

    @property
    def position(self) -> Vector:
        """(3,) position error, body frame [m]."""
        return self.configuration[:3]

    @property
    def attitude(self) -> Vector:
        """(3,) rotation vector from the actual to the desired body, in either of the two frames [rad]."""
        return self.configuration[3:6]

    @property
    def joints(self) -> Vector:
        """(n,) joint errors [rad or m]."""
        return self.configuration[6:]

    @property
    def twist(self) -> Vector:
        """(6,) base twist error, body frame [m/s, rad/s]."""
        return self.velocity[:6]

    @property
    def joint_rates(self) -> Vector:
        """(n,) joint rate errors [rad/s or m/s]."""
        return self.velocity[6:]


def tracking_errors(state: RobotState, reference: Reference) -> TrackingErrors:
    """Return the errors of a state against a reference.

    Args:
        state: actual, q (7+n,) with a unit quaternion, v (6+n,).
        reference: desired, of the same size.
    """
    size = state.v.size
    configuration, velocity, feedforward, quaternion = np.empty(size), np.empty(size), np.empty(size), np.empty(4)
    track(state.q, state.v, reference.q, reference.v, reference.a, configuration, velocity, feedforward, quaternion)
    return TrackingErrors(configuration, velocity, feedforward, quaternion)


@cache
def prepare() -> None:
    """Compile ``tracking_errors`` now, the first time on a machine, and not during a run."""
    still = Reference(0, np.array((*[0.0] * 6, 1.0)), np.zeros(6), np.zeros(6))
    tracking_errors(RobotState(0, still.q, still.v, np.zeros(0), np.zeros(3)), still)


def error_blocks(errors: TrackingErrors) -> dict[str, Vector]:
    """Return the telemetry that all laws have: position, attitude, joint, twist and joint rate errors."""
    return {
        "position_error": errors.position,
        "attitude_error": errors.attitude,
        "joint_error": errors.joints,
        "twist_error": errors.twist,
        "joint_rate_error": errors.joint_rates,
    }
