"""`space_robot.tune`: a tuning file in, the best gains of every law and how sure that is out."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from space_robot_bringup.public.calls import for_python, needing
from space_robot_msgs_py.paths import StrPath
from space_robot_studies.engine.tasks import TIME_LIMIT

if TYPE_CHECKING:
    from space_robot_studies.engine.hooks import StudyHooks
    from space_robot_studies.tune.outcome import TuningResult


@for_python
def tune(
    file: StrPath,
    *,
    law: Sequence[str] = (),
    budget: int | None = None,
    out: StrPath | None = None,
    workers: int | None = None,
    resume: bool = False,
    time_limit: float = TIME_LIMIT,
    hooks: StudyHooks | None = None,
) -> TuningResult:
    """Search the gains of laws with the same budget for each; the result does not depend on the number of workers.

    Args:
        file: a shipped name such as ``tune_short``, or the path of a YAML file.
        law: only these laws of the file; none: all.
        budget: evaluations per law and point of the grid; None: what the file says.
        out: directory of rows, tables and best gains; None: ``runs/<name>``.
        workers: local worker processes; None: one per core.
        resume: go on with what is in the directory; also with a larger budget.
        time_limit: [s] of CPU time of an evaluation; ten times as much may elapse.
        hooks: progress and early end.

    Returns:
        The best gains by law and point, on the draws of the search and on those it never saw.

    Raises:
        SpaceRobotError: the file cannot be used, or a package is not installed, and nothing was written; or no
            evaluation came to a number.
    """
    with needing("tune", "campaign"):
        from space_robot_studies.tune.tune import run_tuning
    from space_robot_studies.tune.spec import load_tuning, tuning_path

    tuning = load_tuning(file, laws=tuple(law), budget=budget)
    place = Path("runs") / tuning_path(file).stem if out is None else Path(out)
    return run_tuning(tuning, place, workers=workers, resume=resume, time_limit=time_limit, hooks=hooks)
