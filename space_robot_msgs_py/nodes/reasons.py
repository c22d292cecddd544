"""Why messages are refused: what is logged of it, not too often, and the newest reasons; and what is new in counts."""

from __future__ import annotations

import re
from collections import Counter, deque
from collections.abc import Callable, Mapping
from time import monotonic

THROTTLE_SECONDS = 10.0
# A stranger may find a new reason with every message.
MAX_REASONS = 64
# Numbers do not make a reason another one.
_NUMBERS = re.compile(r"[-+]?\d[\d.eE+-]*")
# Diagnostics are of so many of their periods.
RECENT = 5


class Reasons:
    """Remembers why messages were refused, by topic.

    Args:
        clock: gives seconds that never go back.

    Attributes:
        newest: why the last message of each topic was refused.
    """

    def __init__(self, clock: Callable[[], float] = monotonic) -> None:
        self._clock = clock
        self.newest: dict[str, str] = {}
        # Topic and kind of reason: when it was logged, and how many came since.
        self._logged: dict[tuple[str, str], tuple[float, int]] = {}

    def add(self, topic: str, why: str) -> str | None:
        """Take one more; what is to be logged of it, the reason and how often it came since the last time, or None."""
        self.newest.pop(topic, None)
        self.newest[topic] = why
        kind, now = (topic, _NUMBERS.sub("#", why)), self._clock()
        since, more = self._logged.get(kind, (-THROTTLE_SECONDS, 0))
        if kind not in self._logged and len(self._logged) >= MAX_REASONS:
            return None
        if kind in self._logged and now - since < THROTTLE_SECONDS:
            self._logged[kind] = since, more + 1
            return None
        self._logged[kind] = now, 0
        return f"{why} ({more} more since the last time)" if more else why

    def values(self) -> dict[str, str]:
        """The newest reason of every topic, and of all, as values of diagnostics."""
        found = {f"reason_{topic}": why for topic, why in sorted(self.newest.items())}
        newest = next(reversed(self.newest.items()), None)
        return found | ({} if newest is None else {"newest_reason": f"{newest[0]}: {newest[1]}"})


class RecentCounts:
    """What has been counted lately, of counts that only grow: what is over is no warning any more."""

    def __init__(self) -> None:
        self._before: deque[Counter[str]] = deque([Counter()], maxlen=RECENT)

    def grown(self, counts: Mapping[str, int]) -> dict[str, int]:
        """By how much each has grown in the last ``RECENT`` calls, where it has; once a period of diagnostics."""
        before = self._before[0]
        # A reset begins again from nothing.
        found = {name: n - (before[name] if n >= before[name] else 0) for name, n in counts.items()}
        self._before.append(Counter(dict(counts)))
        return {name: n for name, n in sorted(found.items()) if n > 0}
