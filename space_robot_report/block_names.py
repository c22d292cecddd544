"""What the numbers of a block of telemetry are called: a block has a name, and its numbers have those of the robot."""

from __future__ import annotations

from collections.abc import Sequence

AXES = ("x", "y", "z")
TWIST = (*AXES, *(f"about {axis}" for axis in AXES))
POSE = (*AXES, "qx", "qy", "qz", "qw")


def block_names(size: int, joints: Sequence[str]) -> tuple[str, ...]:
    """Names of the numbers of a block.

    As many numbers as joints are of the joints, three of the axes, six of a force and a torque or of a twist. Where a
    size may mean two things, and where it means nothing, the numbers are counted.

    Args:
        size: of the block.
        joints: names of the robot's joints.
    """
    names = tuple(joints)
    known = [names, AXES, TWIST, (*TWIST, *names), (*POSE, *names)]
    found = [one for one in known if len(one) == size]
    if size == 1:
        return ("",)
    return found[0] if len(found) == 1 else tuple(f"[{index}]" for index in range(size))
