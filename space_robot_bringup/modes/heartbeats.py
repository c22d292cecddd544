"""Heartbeats of the processes of a paced run, on the steady clock: which of them is silent."""

from __future__ import annotations

from collections.abc import Callable
from time import monotonic

from space_robot_bringup.ends import of_process
from space_robot_bringup.modes.tether import ChildEnd

BEAT_SECONDS = 0.2
# Longer than any process of a busy machine is kept from running, and than a garbage collection takes.
SILENT_SECONDS = 5.0


def silence_of(role: str) -> str:
    """The reason where a process was silent for ``SILENT_SECONDS``."""
    return of_process(role, f"was silent for {SILENT_SECONDS:g} s")


def beating(tether: ChildEnd) -> Callable[[], None]:
    """What a process does often: it tells its parent that its executor runs, every ``BEAT_SECONDS`` at most."""
    last = -BEAT_SECONDS

    def beat() -> None:
        nonlocal last
        if monotonic() - last >= BEAT_SECONDS:
            last = monotonic()
            tether.tell(beat=True)

    return beat


# So long after its last beat a process is no more asked to do anything that may take long.
LATE_SECONDS = 2.0


class Heartbeats:
    """When each process was heard last. One that has never been heard is not there yet, and not missed.

    Args:
        clock: steady [s].
    """

    def __init__(self, clock: Callable[[], float] = monotonic) -> None:
        self._clock, self._heard = clock, dict[str, float]()
        self._looked = clock()

    def hear(self, role: str) -> None:
        """A process says that it runs."""
        self._heard[role] = self._clock()

    def forget(self, role: str) -> None:
        """A process is gone."""
        self._heard.pop(role, None)

    def is_late(self, role: str) -> bool:
        """Whether some beats of a process are missing already."""
        return self._clock() - self._heard.get(role, self._clock()) > LATE_SECONDS

    def silent(self) -> list[str]:
        """Processes that were not heard for ``SILENT_SECONDS``; to be asked often, after all news was taken in."""
        now = self._clock()
        if now - self._looked > SILENT_SECONDS / 2:
            # This process was stopped itself, and has heard nothing of what it would have heard.
            self._heard = dict.fromkeys(self._heard, now)
        self._looked = now
        return [role for role, heard in self._heard.items() if now - heard > SILENT_SECONDS]
