"""What a test asserts of a run: that it followed its reference, what happened in it, that physics was kept."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from space_robot_bringup.public.calls import for_python
from space_robot_bringup.public.judge import judge
from space_robot_msgs_py.errors import SpecError
from space_robot_msgs_py.paths import StrPath

CONSERVED = ("momentum_residual", "energy_residual", "quaternion_residual")


@for_python
def assert_tracking(
    log: StrPath,
    *,
    attitude: float | None = None,
    joints: float | None = None,
    position: float | None = None,
    after: float = 0.0,
) -> None:
    """Assert that the true motion stays near the reference.

    Args:
        log: a run, run directory or .mcap file.
        attitude: largest angle between base and reference [rad].
        joints: largest joint error [rad or m].
        position: largest distance of the base from its reference [m].
        after: errors before are not looked at [s].

    Raises:
        AssertionError: an error is larger, with its time and tick.
        SpecError: no bound is given.
    """
    bounds = {"error.attitude": attitude, "error.joints": joints, "error.position": position}
    window = {"after": after} if after > 0.0 else {}
    wanted = {name: {"never_above": bound, **window} for name, bound in bounds.items() if bound is not None}
    if not wanted:
        raise SpecError("says no bound", key="assert_tracking", accepted="attitude, joints or position")
    _assert(log, wanted)


@for_python
def assert_events(log: StrPath, events: Mapping[str, int]) -> None:
    """Assert how often events happened.

    Args:
        log: a run, run directory or .mcap file.
        events: name as in ``expect``, such as ``jet begins`` or ``mode SAFE``, to how often; 0: never.

    Raises:
        AssertionError: something happened more or less often.
        SpecError: there is no such event in this run.
    """
    wanted: dict[str, dict[str, Any]] = {
        name: {"at_least": count, "at_most": count} if count else {"never": True} for name, count in events.items()
    }
    _assert(log, {"events": wanted})


@for_python
def assert_conserved(log: StrPath, *, momentum: float | None = None, energy: float | None = None) -> None:
    """Assert that the plant balanced momentum and energy, and kept its quaternion at unit length.

    Args:
        log: a run, run directory or .mcap file.
        momentum: largest relative residual [-]; None: the bound that every run is held to.
        energy: likewise.

    Raises:
        AssertionError: something was not conserved.
    """
    found = {check.name: check for check in judge(log, {}) if check.name in CONSERVED}
    lines = [check.line for check in found.values() if not check.passed]
    for name, bound in zip(CONSERVED, (momentum, energy, None), strict=True):
        measured = found[name].measured if name in found else None
        if bound is not None and (measured is None or measured > bound):
            lines.append(f"failed: {name} is {measured}, wanted <= {bound:g}")
    if lines or not found:
        raise AssertionError("\n".join(lines) or "nothing was judged: no tick was completed")


def _assert(log: StrPath, wanted: Mapping[str, Any]) -> None:
    checks = [check for check in judge(log, wanted) if check.about != "run"]
    if lines := [check.line for check in checks if not check.passed]:
        raise AssertionError("\n".join(lines))
