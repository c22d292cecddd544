"""Time of a playback: it runs, stands, is set, and ends."""

from __future__ import annotations


class PlayClock:
    """Simulated time that follows real time while it plays.

    Args:
        start: of the run [s].
        end: of the run [s].

    Attributes:
        now: [s], between the two.
        playing: whether it runs.
        speed: simulated seconds per second.
    """

    def __init__(self, start: float, end: float) -> None:
        self._start, self._end = start, end
        self.now, self.playing, self.speed = start, False, 1.0

    def toggle(self) -> None:
        """Play or pause; played at its end it starts again from the beginning."""
        self.playing = not self.playing
        if self.playing and self.now >= self._end:
            self.now = self._start

    def seek(self, time: float) -> None:
        """Set the time; one outside of the run becomes its nearest end."""
        self.now = min(max(time, self._start), self._end)

    def advance(self, elapsed: float) -> bool:
        """Let real time pass [s]; at the end it stops. Returns whether the time is another now."""
        if not self.playing:
            return False
        self.seek(self.now + elapsed * self.speed)
        self.playing = self.now < self._end
        return True
