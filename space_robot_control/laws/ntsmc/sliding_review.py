"""What a terminal sliding mode law says about its loop gain before a flight."""

from __future__ import annotations

from collections.abc import Sequence

from space_robot_control.laws.base import Review
from space_robot_control.laws.ntsmc.sliding_mode import Floats, SlidingMode

# [m/s, rad/s]: the rate at which a DoF without an error of its own is taken to be disturbed by the others.
DISTURBED = 1e-2


def review_loop_gain(
    sliding: SlidingMode, e: Floats, joint_names: Sequence[str], control_period: float, clamp: bool
) -> Review:
    """Return the loop gain per DoF at the edge of the boundary layer, and warn of chatter and of the cycle of K2.

    Args:
        sliding: with the law's gains.
        e: (m,) errors at the start; the gain is that at the rate they shrink at [m, rad].
        joint_names: the last n of the m.
        control_period: T [s].
        clamp: the law bounds what one command may do, and nothing is warned of.
    """
    gain, cycle = sliding.gains_at(e, DISTURBED), sliding.cycle_rates()
    base = ("x", "y", "z", "rotation x", "rotation y", "rotation z")[6 - (len(e) - len(joint_names)) :]
    names = (*base, *joint_names)
    worst, wildest = (max(range(len(names)), key=values.__getitem__) for values in (gain, cycle))
    shown = ", ".join(f"{name} {value:.2f}" for name, value in zip(names, gain, strict=True))
    period = f"at T = {control_period:g} s"
    facts = (f"loop gain {period} (above about 1 a DoF chatters): {shown}",)
    if clamp:
        return Review(facts)
    warnings = []
    if gain[worst] > 1.0:
        longest = control_period / gain[worst]
        warnings.append(
            f"{names[worst]} chatters {period}: loop gain {gain[worst]:.2f}; clamp: true, or T up to {longest:.2g} s"
        )
    if cycle[wildest] > DISTURBED:
        warnings.append(
            f"{names[wildest]} may cycle at a rate of {cycle[wildest]:.2g} {period}: k2 is too large; clamp: true"
        )
    return Review(facts, tuple(warnings))
