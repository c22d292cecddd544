"""SIGINT, SIGTERM and a limit on time as a reason to end, not as a traceback."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from time import monotonic, process_time
from types import FrameType, TracebackType
from typing import Any

REASONS = {signal.SIGINT: "interrupted", signal.SIGTERM: "terminated"}
TIMEOUT = "timeout"
# A run that has not looked at the reason for so long is stuck in a law or a compiler.
GRACE_SECONDS = 2.0
LOOK_SECONDS = 0.1


class Interrupted(BaseException):
    """What was going on is over, and why. No ``Exception``, so that no law takes it for one of its own.

    Args:
        reason: ``interrupted``, ``terminated`` or ``timeout``.
    """

    def __init__(self, reason: str) -> None:
        super().__init__(reason)
        self.reason = reason


class StopFlag:
    """While in its block, the given signals set ``reason`` instead of ending the process; the first one counts.

    Args:
        signals: which ones, out of SIGINT and SIGTERM.
    """

    def __init__(self, *signals: signal.Signals) -> None:
        self._signals = signals
        self._before: dict[signal.Signals, Any] = {}
        self._reason: str | None = None

    @property
    def reason(self) -> str | None:
        """Why to end, once there is a reason."""
        return self._reason

    def __enter__(self) -> StopFlag:
        for number in self._signals:
            self._before[number] = signal.signal(number, self._on_signal)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def _on_signal(self, number: int, frame: FrameType | None) -> None:
        if self._reason is None:
            self._reason = REASONS[signal.Signals(number)]


class RunStop(StopFlag):
    """A StopFlag that a run cannot overhear, and that may limit its time.

    As long as nothing has looked at ``reason`` there is nothing to be ended in order: a reason then raises
    ``Interrupted`` in the main thread at once. Later it is raised there when the reason is not looked at for
    ``GRACE_SECONDS``, and again until it is. Whatever catches ``Interrupted`` looks at the reason.

    Args:
        signals: as of a StopFlag; of the main thread, as everything here.
        timeout: the reason is ``timeout`` after so many seconds of CPU time of this process, or when ``reach`` is
            called with no new tick for so many seconds; None: no limit.
    """

    def __init__(self, *signals: signal.Signals, timeout: float | None = None) -> None:
        super().__init__(*signals)
        self._timeout = timeout
        self._looked = self._heard = False
        self._due: float | None = 0.0
        self._progress = self._cpu = 0.0
        self._tick: int | None = None

    @property
    def reason(self) -> str | None:
        """Why to end, once there is a reason; who reads it ends."""
        self._looked = True
        self._heard = self._reason is not None
        return self._reason

    def end(self, reason: str) -> None:
        """Give the reason; the first one counts. It may come from any thread."""
        if self._reason is None:
            if self._due is not None:
                self._due = monotonic() + (GRACE_SECONDS if self._looked else 0.0)
            self._reason = reason
            signal.setitimer(signal.ITIMER_REAL, LOOK_SECONDS, LOOK_SECONDS)

    def reach(self, tick: int) -> None:
        """The run has reached this tick."""
        if tick != self._tick:
            self._tick, self._progress = tick, monotonic()

    def lift(self) -> None:
        """No limit on time from now on."""
        self._timeout = None

    def ending(self) -> None:
        """What runs ends in order by itself: nothing is raised from now on."""
        self._due = self._timeout = None

    def __enter__(self) -> RunStop:
        super().__enter__()
        self._progress, self._cpu = monotonic(), process_time()
        self._before[signal.SIGALRM] = signal.signal(signal.SIGALRM, self._on_alarm)
        if self._timeout is not None:
            signal.setitimer(signal.ITIMER_REAL, LOOK_SECONDS, LOOK_SECONDS)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        super().__exit__(kind, error, trace)

    def _on_signal(self, number: int, frame: FrameType | None) -> None:
        self.end(REASONS[signal.Signals(number)])
        self._raise_if_due()

    def _on_alarm(self, number: int, frame: FrameType | None) -> None:
        if self._timeout is not None and self._overdue(self._timeout):
            self.end(TIMEOUT)
        self._raise_if_due()

    def _overdue(self, limit: float) -> bool:
        return process_time() - self._cpu >= limit or monotonic() - self._progress >= limit

    def _raise_if_due(self) -> None:
        if self._reason is None or self._heard or self._due is None:
            return
        if monotonic() >= self._due:
            self._due = monotonic() + GRACE_SECONDS
            raise Interrupted(self._reason)


@contextmanager
def raising(*signals: signal.Signals) -> Iterator[None]:
    """In its block the signals raise ``Interrupted`` in the main thread."""

    def on_signal(number: int, frame: FrameType | None) -> None:
        raise Interrupted(REASONS[signal.Signals(number)])

    before = {number: signal.signal(number, on_signal) for number in signals}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
