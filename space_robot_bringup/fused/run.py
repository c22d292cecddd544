"""A composition run in one compiled call, where its parts can be; the loop of ``modes.headless`` has the same bits."""

from __future__ import annotations

from space_robot_bringup.compose.composition import Composition
from space_robot_bringup.fused.prepared import prepared
from space_robot_bringup.fused.sink import FusedRun


def compiled_run(composition: Composition, ticks: int | None = None) -> FusedRun | None:
    """Run a composition in one call.

    Args:
        composition: of the run.
        ticks: stop after so many; None: the whole run.

    Returns:
        The run; None where a part of it is not compiled, or where it does not complete: the loop has the words for why.

    Raises:
        SpaceRobotError: plant, law or reference cannot be made.
    """
    run = prepared(composition, ticks)
    return None if run is None else run.completed()
