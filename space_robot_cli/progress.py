"""How far a run is: a bar on a terminal, a few plain lines elsewhere."""

from __future__ import annotations

from types import TracebackType

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeRemainingColumn
from rich.progress import Progress as RichProgress

PLAIN_LINES = 4


class Progress:
    """Shows the tick a run, or the run a campaign, has reached, and on a terminal when it will be over.

    Args:
        console: where to; its own terminal detection decides between bar and lines.
        steps: the last one.
        quiet: show nothing.
        unit: what is counted.
    """

    def __init__(self, console: Console, steps: int, *, quiet: bool, unit: str = "tick") -> None:
        self._console, self._steps, self._quiet, self._unit = console, steps, quiet, unit
        self._shown_quarter = 0
        self._bar: RichProgress | None = None
        if console.is_terminal and not quiet:
            columns = (TextColumn("running"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
            self._bar = RichProgress(*columns, console=console, transient=True)
            self._task = self._bar.add_task("running", total=steps)

    def begin(self, tick: int) -> None:
        """Start from here: what was done before says nothing about how fast it goes."""
        self._shown_quarter = PLAIN_LINES * tick // self._steps
        if self._bar is not None:
            self._bar.reset(self._task, completed=tick)

    def reach(self, tick: int) -> None:
        """It has reached this tick."""
        if self._bar is not None:
            self._bar.update(self._task, completed=tick)
        elif not self._quiet:
            quarter = PLAIN_LINES * tick // self._steps
            if quarter > self._shown_quarter:
                self._shown_quarter = quarter
                self._console.print(f"{self._unit} {tick} of {self._steps}")

    def __enter__(self) -> Progress:
        if self._bar is not None:
            self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._bar is not None:
            self._bar.stop()
