"""What the commands of many runs share: options, progress, what is compiled first, and how they are interrupted."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console

from space_robot_cli.app import FAILED, warn
from space_robot_cli.interrupt import Interrupt
from space_robot_cli.progress import Progress

if TYPE_CHECKING:
    from space_robot_studies.engine.hooks import StudyHooks

WorkersOption = Annotated[int | None, typer.Option(help="local worker processes; default: one per core")]
ResumeOption = Annotated[bool, typer.Option("--resume", help="go on with what is in the directory")]
TimeLimitOption = Annotated[
    float | None,
    typer.Option(metavar="SECONDS", help="CPU time a run may take, ten times as much may elapse; default: 300"),
]


def single_threaded() -> None:
    """Ask numeric libraries for one thread each; only before they are imported.

    The matrices here are small, and a process with one thread starts its workers within milliseconds.
    """
    from space_robot_bringup.modes.pinned import PINNED

    os.environ.update(PINNED)


@contextmanager
def study(console: Console, *, quiet: bool) -> Iterator[StudyHooks]:
    """Hooks of a study that shows its progress; SIGINT and SIGTERM end it in one line within seconds.

    Args:
        console: for progress.
        quiet: no progress.
    """
    from space_robot_studies.engine.hooks import StudyHooks

    shown: list[Progress] = []

    def begin(done: int, total: int) -> None:
        stop_progress()
        shown.append(Progress(console, total, quiet=quiet, unit="run").__enter__())
        shown[-1].begin(done)

    def stop_progress() -> None:
        while shown:
            shown.pop().__exit__(None, None, None)

    with Interrupt() as interrupt:
        try:
            yield StudyHooks(begin, lambda done: shown[-1].reach(done), lambda: interrupt.reason, warn)
        except KeyboardInterrupt:
            stop_progress()
            print_interrupted(console, interrupt.reason or "interrupted")
            raise typer.Exit(FAILED) from None
        finally:
            stop_progress()


def print_interrupted(console: Console, reason: str) -> None:
    """Say in one line that a study did not end by itself."""
    console.print(f"{reason}: finished runs are kept; go on with --resume", markup=False, soft_wrap=True)


def announce(console: Console, laws: Iterable[str], *, plant: bool = True) -> None:
    """Say what has to be compiled before the first run, if something has to."""
    from space_robot_bringup.modes.compilation import notice

    # What runs elsewhere is compiled there.
    if line := notice(laws, plant=plant, many=plant):
        console.print(line)
