"""`space_robot.compare`: laws side by side on the same tasks."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING

from space_robot_bringup.public.calls import for_python, needing
from space_robot_msgs_py.paths import StrPath
from space_robot_studies.engine.tasks import TIME_LIMIT

if TYPE_CHECKING:
    from space_robot_studies.compare.compare import ComparisonResult
    from space_robot_studies.engine.hooks import StudyHooks

SHIPPED = ("compare_mini", "compare_servicer")


@for_python
def compare(
    files: StrPath | Sequence[StrPath] = SHIPPED,
    *,
    out: StrPath = "out/compare",
    runs: int | None = None,
    workers: int | None = None,
    resume: bool = False,
    time_limit: float = TIME_LIMIT,
    hooks: StudyHooks | None = None,
) -> ComparisonResult:
    """Run campaigns that vary the law, and put what each law did side by side.

    Args:
        files: shipped names or paths of campaign files.
        out: directory of everything that is written.
        runs: per point of the grid; None: what the files say.
        workers: worker processes; None: one per core.
        resume: go on with what is in the directory.
        time_limit: [s] of CPU time of a run; ten times as much may elapse.
        hooks: progress and early end.

    Returns:
        Medians by law, period and condition, and what a control cycle of each law costs.

    Raises:
        SpaceRobotError: a campaign cannot be run as it is, or a package is not installed; nothing was written.
    """
    with needing("compare", "campaign"):
        from space_robot_studies.compare.compare import compare as run_comparison
    listed = [files] if isinstance(files, str | os.PathLike) else files
    return run_comparison(
        [os.fspath(file) for file in listed],
        os.fspath(out),
        runs=runs,
        workers=workers,
        resume=resume,
        time_limit=time_limit,
        hooks=hooks,
    )
