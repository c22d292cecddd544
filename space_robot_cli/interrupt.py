"""SIGINT and SIGTERM to a command of many runs: it ends within seconds, whatever it is doing."""

from __future__ import annotations

import signal
from types import FrameType, TracebackType
from typing import Any

from space_robot_bringup.modes.signals import REASONS

# What polls ``reason`` ends by then; anything else, such as a compilation, is interrupted where it is.
GRACE_SECONDS = 2.0


class Interrupt:
    """While in its block, a signal sets ``reason``; a second one, or two seconds, raise KeyboardInterrupt."""

    def __init__(self) -> None:
        self._before: dict[signal.Signals, Any] = {}
        self.reason: str | None = None

    def __enter__(self) -> Interrupt:
        for number in REASONS:
            self._before[number] = signal.signal(number, self._on_signal)
        self._before[signal.SIGALRM] = signal.signal(signal.SIGALRM, self._raise)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def _on_signal(self, number: int, frame: FrameType | None) -> None:
        if self.reason is not None:
            raise KeyboardInterrupt
        self.reason = REASONS[signal.Signals(number)]
        signal.setitimer(signal.ITIMER_REAL, GRACE_SECONDS)

    def _raise(self, number: int, frame: FrameType | None) -> None:
        raise KeyboardInterrupt
