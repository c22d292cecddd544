"""When, how long and how often a condition holds, tick by tick: what a run has to show of it, and what is not judged.

Little is remembered of a run: where the condition began to hold, how often it did, and what is still to be answered.
What would be known only after the end of the run is not judged, and so never satisfied.
"""

from __future__ import annotations

from collections import deque

from space_robot_bringup.experiment.expectations import Temporal
from space_robot_bringup.judge.window import Clock, Finding, Now, Window, nanoseconds
from space_robot_bringup.judge.wording import how_often, unopened
from space_robot_msgs_py.interfaces import NANOSECONDS


class Never:
    """The condition never holds, or never so long, in the window.

    Args:
        spec: what is expected.
        clock: of the run.
        highest: of the numbers seen the largest is the one to report, else the smallest.
    """

    def __init__(self, spec: Temporal, clock: Clock, *, highest: bool = True) -> None:
        self._window, self._clock, self._sign = Window(spec), clock, 1.0 if highest else -1.0
        self._for = nanoseconds(spec.for_)
        self._since: int | None = None
        self._worst: tuple[float, str] | None = None
        self._found: Finding | None = None
        self._last = -1

    def step(self, now: Now) -> None:
        """Take the next tick."""
        self._window.opens(now)
        self._last = now.stamp
        if not self._window.open:
            self._since = None
            return
        if now.value is not None and (self._worst is None or self._sign * now.value > self._sign * self._worst[0]):
            self._worst = now.value, f"{now.said} {self._clock.at(now.stamp)}"
        if not now.holds:
            self._since = None
            return
        self._since = now.stamp if self._since is None else self._since
        if self._found is None and now.stamp - self._since >= self._for:
            begun = f", since {self._since / NANOSECONDS:g} s" if self._for else ""
            self._found = Finding(False, f"{now.said} {self._clock.at(now.stamp)}{begun}")

    def finish(self) -> Finding:
        """What the run showed."""
        measured = None if self._worst is None else self._worst[0]
        if self._found is not None:
            worst = f"; at worst {self._worst[1]}" if self._worst is not None else ""
            return Finding(False, f"{self._found.reason}{worst}", measured)
        if missing := self._window.unseen(self._clock, self._last):
            return Finding(None, missing, measured)
        if self._since is not None and self._for and self._window.ends_with_run:
            return Finding(None, f"it holds since {self._since / NANOSECONDS:g} s, and the run ends before", measured)
        return Finding(True, f"at worst {self._worst[1]}" if self._worst is not None else "", measured)


class Within:
    """The condition holds soon enough after each time that the window begins, and so long as is wanted.

    Args:
        spec: what is expected.
        clock: of the run.
    """

    def __init__(self, spec: Temporal, clock: Clock) -> None:
        self._spec, self._window, self._clock = spec, Window(spec), clock
        self._span, self._for = nanoseconds(spec.within), nanoseconds(spec.for_)
        # Beginnings without an answer yet: at most as many as there are ticks in the time an answer may take.
        self._waiting: deque[int] = deque()
        self._since: int | None = None
        self._found: Finding | None = None
        self._slowest, self._last = 0, -1

    def step(self, now: Now) -> None:
        """Take the next tick."""
        self._last = now.stamp
        if self._window.opens(now):
            self._waiting.append(now.stamp)
        self._since = None if not now.holds else now.stamp if self._since is None else self._since
        while self._waiting and self._answered(self._waiting[0], now):
            self._waiting.popleft()

    def _answered(self, begun: int, now: Now) -> bool:
        """Whether it is known by now what followed on a beginning [ns]."""
        held = None if self._since is None else max(self._since, begun)
        if held is not None and held - begun <= self._span:
            if now.stamp - held < self._for:
                return False
            self._slowest = max(self._slowest, held - begun)
            return True
        if now.stamp - begun < self._span:
            return False
        if self._found is None:
            late = f"{(now.stamp - begun) / NANOSECONDS:g} s after {begun / NANOSECONDS:g} s"
            self._found = Finding(False, f"{now.said} {self._clock.at(now.stamp)}, {late}", now.value)
        return True

    def finish(self) -> Finding:
        """What the run showed."""
        if self._found is not None:
            return self._found
        if not self._window.opened:
            return Finding(None, unopened(self._spec))
        if self._waiting:
            begun, end = self._waiting[0] / NANOSECONDS, self._last / NANOSECONDS
            return Finding(None, f"the run ended at {end:g} s, too soon after {begun:g} s")
        seconds = self._slowest / NANOSECONDS
        return Finding(True, f"after {seconds:g} s", seconds)


class Count:
    """How often the condition begins to hold in the window, for as long as is wanted.

    Args:
        spec: what is expected.
        clock: of the run.
    """

    def __init__(self, spec: Temporal, clock: Clock) -> None:
        self._window, self._clock, self._for = Window(spec), clock, nanoseconds(spec.for_)
        self._most, self._least = spec.at_most, spec.at_least or 0
        self._since: int | None = None
        self._counted = False
        self._count, self._last, self._at = 0, -1, ""

    def step(self, now: Now) -> None:
        """Take the next tick."""
        self._window.opens(now)
        self._last = now.stamp
        if not (self._window.open and now.holds):
            self._since, self._counted = None, False
            return
        self._since = now.stamp if self._since is None else self._since
        if not self._counted and now.stamp - self._since >= self._for:
            self._count, self._counted, self._at = self._count + 1, True, self._clock.at(now.stamp)

    def finish(self) -> Finding:
        """What the run showed."""
        times = how_often(self._count) + (f", last {self._at}" if self._count else "")
        if self._most is not None and self._count > self._most:
            return Finding(False, times, float(self._count))
        if self._most is None and self._count >= self._least:
            return Finding(True, times, float(self._count))
        if missing := self._window.unseen(self._clock, self._last):
            return Finding(None, f"{missing}; {times}", float(self._count))
        if self._most is not None and self._since is not None and not self._counted and self._window.ends_with_run:
            return Finding(None, f"it holds since {self._since / NANOSECONDS:g} s, and the run ends before; {times}")
        return Finding(self._count >= self._least, times, float(self._count))


class AtEnd:
    """The condition holds at the last tick of the run, and has held so long as is wanted.

    Args:
        spec: what is expected.
        clock: of the run.
    """

    def __init__(self, spec: Temporal, clock: Clock) -> None:
        self._clock, self._for = clock, nanoseconds(spec.for_)
        self._since: int | None = None
        self._now: Now | None = None

    def step(self, now: Now) -> None:
        """Take the next tick."""
        self._now = now
        self._since = None if not now.holds else now.stamp if self._since is None else self._since

    def finish(self) -> Finding:
        """What the run showed."""
        now = self._now
        if now is None or now.stamp < self._clock.last:
            return Finding(None, "the run ended before its end")
        said = f"{now.said} {self._clock.at(now.stamp)}"
        if self._since is None:
            return Finding(False, said, now.value)
        held = now.stamp - self._since >= self._for
        return Finding(held, f"{said}, since {self._since / NANOSECONDS:g} s", now.value)


Watch = Never | Within | Count | AtEnd


def watch_of(spec: Temporal, clock: Clock, *, highest: bool = True) -> Watch:
    """What watches a condition; see ``Never`` for ``highest``."""
    if spec.within is not None:
        return Within(spec, clock)
    if spec.counts:
        return Count(spec, clock)
    return AtEnd(spec, clock) if spec.at_end else Never(spec, clock, highest=highest)
