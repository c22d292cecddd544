"""SIGINT and SIGTERM as a reason to end, not as a traceback."""

from __future__ import annotations

import signal
from types import FrameType, TracebackType
from typing import Any

REASONS = {signal.SIGINT: "interrupted", signal.SIGTERM: "terminated"}


class StopFlag:
    """While in its block, the given signals set ``reason`` instead of ending the process; the first one counts.

    Args:
        signals: which ones, out of SIGINT and SIGTERM.
    """

    def __init__(self, *signals: signal.Signals) -> None:
        self._signals = signals
        self._before: dict[signal.Signals, Any] = {}
        self.reason: str | None = None

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
        if self.reason is None:
            self.reason = REASONS[signal.Signals(number)]
