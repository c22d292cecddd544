"""`space_robot.reproduce`: the figures of a paper run and its claims judged."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from space_robot_bringup.public.calls import for_python
from space_robot_bringup.reproduce.plan import Plan, choose_figures, load_plan
from space_robot_bringup.reproduce.reproduction import FlownFigure, check_workers, prepare
from space_robot_bringup.reproduce.reproduction import reproduce as run_figures
from space_robot_bringup.reproduce.summary import Data, passed, summary
from space_robot_bringup.reproduce.workers import cores
from space_robot_msgs_py.paths import StrPath


@dataclass(frozen=True, eq=False, slots=True)
class Reproduction:
    """What a reproduction found.

    Attributes:
        plan: of the paper.
        directory: its bags are in ``runs/``.
        end_reason: ``completed``, or why it was stopped.
        figures: with runs and judged claims, in order; empty unless completed.
    """

    plan: Plan
    directory: Path
    end_reason: str
    figures: tuple[FlownFigure, ...]

    @property
    def passed(self) -> bool:
        """Every verdict is the documented one, and no run failed that should not."""
        return self.end_reason == "completed" and passed(self.figures)

    def to_dict(self) -> Data:
        """All runs, numbers and claims as plain data."""
        return summary(self.plan, self.figures, {})


@for_python
def reproduce(
    paper: StrPath,
    figures: str | Sequence[str] = (),
    *,
    out: StrPath | None = None,
    workers: int | None = None,
    on_done: Callable[[int], None] = lambda done: None,
    stop: Callable[[], str | None] = lambda: None,
) -> Reproduction:
    """Run the figures of a paper and judge its claims one by one; the result does not depend on the number of workers.

    Workers are processes that import the main module again: in a script, call this under
    ``if __name__ == "__main__":``. The page with the pictures is written by ``space-robot reproduce``.

    Args:
        paper: a shipped name such as ``liu2023``, or the path of a manifest.
        figures: which; none: all.
        out: directory of the bags; None: ``out/<paper>``.
        workers: worker processes; None: one per core.
        on_done: called with the number of finished runs.
        stop: asked often; a reason ends everything.

    Raises:
        SpaceRobotError: the manifest or an argument cannot be used, or a log cannot be written.
    """
    check_workers(workers)
    plan = load_plan(paper)
    chosen = choose_figures(plan.manifest, [figures] if isinstance(figures, str) else figures)
    directory = Path("out") / plan.name if out is None else Path(out)
    prepare(plan, chosen, directory)
    found = run_figures(plan, chosen, directory, workers=workers or cores(), on_done=on_done, stop=stop)
    reason = "completed" if found is not None else stop() or "interrupted"
    return Reproduction(plan, directory, reason, tuple(found or ()))
