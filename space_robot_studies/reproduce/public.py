"""`space_robot.reproduce`: the figures of a paper run and its claims judged."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from space_robot_bringup.public.calls import for_python
from space_robot_msgs_py.paths import StrPath
from space_robot_studies.engine.tasks import TIME_LIMIT

if TYPE_CHECKING:
    from space_robot_studies.engine.hooks import StudyHooks
    from space_robot_studies.reproduce.reproduction import Reproduction


@for_python
def reproduce(
    paper: StrPath,
    figures: str | Sequence[str] = (),
    *,
    out: StrPath | None = None,
    workers: int | None = None,
    resume: bool = False,
    time_limit: float = TIME_LIMIT,
    hooks: StudyHooks | None = None,
) -> Reproduction:
    """Run the figures of a paper and judge its claims one by one; the result does not depend on the number of workers.

    The page with the pictures is written by ``space-robot reproduce``.

    Args:
        paper: a shipped name such as ``liu2023``, or the path of a manifest.
        figures: which; none: all.
        out: directory of the bags; None: ``out/<paper>``.
        workers: worker processes; None: one per core.
        resume: keep the finished runs in the directory that are still the same.
        time_limit: [s] of CPU time of a run; ten times as much may elapse.
        hooks: progress and early end.

    Raises:
        SpaceRobotError: the manifest or an argument cannot be used, or a log cannot be written.
    """
    from space_robot_studies.reproduce.plan import load_plan
    from space_robot_studies.reproduce.reproduction import reproduce as run_figures

    plan = load_plan(paper)
    return run_figures(
        plan,
        Path("out") / plan.name if out is None else Path(out),
        figures=[figures] if isinstance(figures, str) else figures,
        workers=workers,
        resume=resume,
        time_limit=time_limit,
        hooks=hooks,
    )
