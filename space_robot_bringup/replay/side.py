"""What both sides of a replay have in common: a recording, its codec, a comparison and the outcome."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from space_robot_bringup.ends import is_of_process
from space_robot_bringup.replay.comparison import Comparison, Tolerance
from space_robot_bringup.replay.recording import Recording
from space_robot_bringup.replay.result import Against, Outcome, absent_topics
from space_robot_msgs_py.codec.codecs import TickCodec
from space_robot_msgs_py.topics import Topic


class SideReplay:
    """One side of a recorded run, computed again and compared; a subclass computes it.

    Args:
        recording: the run.
        tolerance: of the comparison.
    """

    def __init__(self, recording: Recording, tolerance: Tolerance) -> None:
        self._recording, self._tolerance = recording, tolerance
        self._composition = recording.composition
        self._period = self._composition.experiment.period
        self._codec = TickCodec(self._composition.joint_names)
        self._comparison = Comparison(self._composition.joint_names, tolerance)
        reason = recording.end_reason or ""
        # What a killed process would have computed next is in no log, and is no difference.
        self._ended = "" if is_of_process(reason) else reason
        # What was not compared, and how often.
        self._notes: Counter[str] = Counter()
        self._ticks, self._last = 0, -1

    def _outcome(self, against: Against, computed: Sequence[Topic], stop: str, remarks: Sequence[str] = ()) -> Outcome:
        """The verdict on what was compared.

        Args:
            against: which side this is.
            computed: topics that it computes.
            stop: why nothing more was compared; empty: everything was.
            remarks: that come first.
        """
        notes = (f"{count} {what}" for what, count in self._notes.items())
        absent = absent_topics(self._comparison, computed, self._tolerance.ignore)
        said = (*remarks, *notes, *([stop] if stop else []))
        return Outcome(against, self._comparison, self._ticks, self._last, absent, said)
