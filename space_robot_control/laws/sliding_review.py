"""What a terminal sliding mode law says about its loop gain before a flight."""

from __future__ import annotations

from collections.abc import Sequence

from space_robot_control.laws.base import Review
from space_robot_control.laws.sliding import Floats, SlidingMode

# [m/s, rad/s]: the rate at which a DoF without an error of its own is taken to be disturbed by the others.
DISTURBED = 1e-2


def review_loop_gain(
    sliding: SlidingMode, e: Floats, joint_names: Sequence[str], control_period: float, clamp: bool
) -> Review:
    """Return the loop gain per DoF at the edge of the boundary layer, at the rate the start error leads to.

    Args:
        sliding: with the law's gains.
        e: (m,) errors at the start [m, rad].
        joint_names: the last n of the m.
        control_period: T [s].
        clamp: the law bounds what one command may do, so that a gain above 1 is no warning.
    """
    gain = sliding.gains_at(e, DISTURBED)
    base = ("x", "y", "z", "rotation x", "rotation y", "rotation z")[6 - (len(e) - len(joint_names)) :]
    names = (*base, *joint_names)
    worst = max(range(len(gain)), key=gain.__getitem__)
    shown = ", ".join(f"{name} {value:.2f}" for name, value in zip(names, gain, strict=True))
    longest = control_period / gain[worst]
    facts = (f"loop gain (above about 1 a DoF chatters): {shown}; 1 at T = {longest:.3g} s",)
    if clamp or gain[worst] <= 1.0:
        return Review(facts)
    warning = (
        f"loop gain {gain[worst]:.2f} of {names[worst]} at T = {control_period:g} s: above about 1 one held command "
        f"throws s past zero; clamp: true, or a control period below {longest:.2g} s"
    )
    return Review(facts, (warning,))
